import math

import numpy as np
import scipy.linalg
import torch
from faultpath_quadrotor import so3
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

F64 = torch.float64
axis_component = st.floats(-1, 1)
angles = st.one_of(st.floats(0, math.pi - 1e-6), st.sampled_from([0.0, 1e-9, 1e-5, 1e-3, 3.14159]))


@st.composite
def rotation_vectors(draw) -> Tensor:
    """Vectors [3, 1] of norm below pi in any direction."""
    axis = torch.tensor([draw(axis_component) for _ in range(3)], dtype=F64)
    if axis.norm() < 1e-3:
        axis = torch.tensor([1.0, 0.0, 0.0], dtype=F64)
    return (axis / axis.norm() * draw(angles))[:, None]


def close(a: Tensor, b: Tensor, atol: float = 1e-12) -> bool:
    return torch.allclose(a, b, rtol=0, atol=atol)


@given(rotation_vectors())
def test_exp_is_the_matrix_exponential_and_log_inverts_it(phi):
    x, y, z = phi[:, 0].tolist()
    # SciPy's: torch.linalg.matrix_exp is off by 2e-11 at small angles.
    expected = torch.from_numpy(scipy.linalg.expm(np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])))
    assert close(so3.exp(phi)[..., 0], expected)
    assert close(so3.log(so3.exp(phi)), phi, atol=1e-9)


@given(rotation_vectors(), rotation_vectors(), rotation_vectors())
def test_compose_is_the_matrix_product_and_acts_on_vectors(a, b, v):
    first, second = so3.exp(a), so3.exp(b)
    assert close(so3.compose(first, second)[..., 0], first[..., 0] @ second[..., 0])
    assert close(so3.rotate(first, v)[:, 0], first[..., 0] @ v[:, 0])
    assert close(so3.rotate_back(first, so3.rotate(first, v)), v)


@settings(deadline=None, max_examples=20)
@given(rotation_vectors())
def test_gradients_are_right_everywhere_and_finite_at_the_identity(phi):
    variable = phi.clone().requires_grad_()
    assert torch.autograd.gradcheck(so3.exp, variable, atol=1e-5)
    moved = so3.log(so3.exp(variable))
    if phi.norm() < 3.0:
        (gradient,) = torch.autograd.grad(moved.sum(), variable)
        assert close(gradient, torch.ones_like(phi), atol=1e-6)


def test_project_returns_the_nearest_rotation():
    generator = torch.Generator().manual_seed(1)
    rotation = so3.exp(torch.randn(3, 64, dtype=F64, generator=generator))
    noise = 0.1 * torch.randn(3, 3, 64, dtype=F64, generator=generator)
    matrix = rotation + noise
    nearest = so3.project(matrix)
    assert close(so3.project(rotation), rotation)
    assert close(so3.compose(nearest.transpose(0, 1), nearest)[..., 0], torch.eye(3, dtype=F64))
    # Optimality: the polar factor R^T M is symmetric.
    polar = so3.compose(nearest.transpose(0, 1), matrix)
    assert close(polar, polar.transpose(0, 1))
    assert not close(matrix, nearest, atol=1e-2)
