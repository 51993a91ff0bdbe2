// Philox 4x64 with ten rounds (Salmon et al. 2011): the words of NumPy's generator.
//
// AVX-512 computes eight blocks at a time, a product of two words put together from four of their
// halves; narrower vectors gain nothing on the processor's own wide product.
#pragma once

#include "simd64.hpp"

namespace {

constexpr uint64_t MULTIPLIERS[2] = {0xD2E7470EE14C6C93, 0xCA5A826395121157};
constexpr uint64_t WEYL[2] = {0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B};
constexpr int ROUNDS = 10;

INLINE void multiply(uint64_t a, uint64_t b, uint64_t& high, uint64_t& low) {
  const auto product = static_cast<unsigned __int128>(a) * b;
  high = static_cast<uint64_t>(product >> 64);
  low = static_cast<uint64_t>(product);
}

#if defined(__AVX512F__)
typedef uint64_t Words __attribute__((vector_size(8 * DOUBLES)));

// Products of the low halves of each lane.
INLINE Words halves(Words a, Words b) {
  return (Words)_mm512_mul_epu32((__m512i)a, (__m512i)b);
}

INLINE void multiply(uint64_t a, Words b, Words& high, Words& low) {
  constexpr uint64_t HALF = 0xffffffff;
  const Words a_low = Words{} + (a & HALF), a_high = Words{} + (a >> 32), b_high = b >> 32;
  const Words least = halves(a_low, b);
  const Words carried = halves(a_low, b_high) + (least >> 32);
  const Words middle = halves(a_high, b) + (carried & HALF);
  high = halves(a_high, b_high) + (carried >> 32) + (middle >> 32);
  low = (middle << 32) | (least & HALF);
}
#endif

// One block for each lane of `counter`, in place.
template <typename T>
INLINE void encrypt(const uint64_t* key, T* counter) {
  uint64_t k0 = key[0], k1 = key[1];
#pragma GCC unroll 10
  for (int round = 0; round < ROUNDS; ++round, k0 += WEYL[0], k1 += WEYL[1]) {
    T high_0, low_0, high_1, low_1;
    multiply(MULTIPLIERS[0], counter[0], high_0, low_0);
    multiply(MULTIPLIERS[1], counter[2], high_1, low_1);
    counter[0] = high_1 ^ counter[1] ^ k0;
    counter[2] = high_0 ^ counter[3] ^ k1;
    counter[1] = low_1;
    counter[3] = low_0;
  }
}

// The first `count` words, a multiple of four, that NumPy's Philox gives from a key [2] at a step:
// its counter holds the step in the high word and is raised before each block.
void draw(const uint64_t* key, uint64_t step, int64_t count, uint64_t* words) {
  int64_t block = 0;
  const int64_t blocks = count / 4;
#if defined(__AVX512F__)
  for (; block + DOUBLES <= blocks; block += DOUBLES) {
    Words counter[4] = {};
    for (int lane = 0; lane < DOUBLES; ++lane) counter[0][lane] = block + lane + 1;
    counter[3] = Words{} + step;
    encrypt(key, counter);
    for (int lane = 0; lane < DOUBLES; ++lane)
      for (int word = 0; word < 4; ++word) words[4 * (block + lane) + word] = counter[word][lane];
  }
#endif
  for (; block < blocks; ++block) {
    uint64_t counter[4] = {static_cast<uint64_t>(block) + 1, 0, 0, step};
    encrypt(key, counter);
    std::memcpy(words + 4 * block, counter, sizeof counter);
  }
}

}  // namespace
