// The ledger: a link to a claim opens it, and paper gets every claim open.
{
  const claims = [...document.querySelectorAll("details.claim")];
  const open = () => {
    const claim = claims.find((c) => `#${c.id}` === decodeURIComponent(location.hash));
    if (!claim) return;
    for (const all of ["only-all", "kind-all"]) document.getElementById(all).checked = true;
    claim.open = true;
    claim.scrollIntoView();
  };
  window.addEventListener("hashchange", open);
  open();

  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    for (const each of opened) each.open = true;
  });
  window.addEventListener("afterprint", () => { for (const each of opened) each.open = false; });
}
