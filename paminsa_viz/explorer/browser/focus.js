/**
 * The focus of a button that is pressed and goes: where a task runs, the button that stops it stands
 * there, and at the end the first one again. Some only cannot be pressed meanwhile. Of buttons in a
 * row the one beside it takes the focus, and if the row goes, what is nearest.
 *
 * Left alone, the focus would be nowhere, and who has no mouse would not know where they are.
 */
window.paminsaFocus = (config) => {
  "use strict";
  const { signal } = config;
  const NEAREST = "button:enabled, input:enabled:not([type=hidden]), [role=slider]";
  let held = null; // the button that has the focus, or had it, and where: see `focusin`
  const isFree = () => [null, document.body].includes(document.activeElement);
  const buttonOf = (row) => row.querySelector(":scope > button[id]:enabled");
  const seenOf = (row) => [...row.querySelectorAll(NEAREST)].find((one) => one.getClientRects().length);
  const go = (button) => button.focus({ preventScroll: true });
  /** The first of what is nearest to a place of a list, by what `find` finds in each of them. */
  const nearest = (list, place, find) => list.map((one, now) => ({ one, far: Math.abs(now - place) }))
    .sort((one, other) => one.far - other.far).map(({ one }) => find(one)).find(Boolean);
  const observer = new MutationObserver(() => {
    if (!held || !isFree()) return;
    const { button, container, rows, place, group, index } = held;
    if (button.isConnected) return button.disabled ? undefined : go(button);
    const now = [...container.children];
    const next = nearest(now, place, (row) => !rows.includes(row) && buttonOf(row))
      ?? (group && nearest([...group.children], index, (one) => one.isConnected && one.matches(":enabled") && one))
      ?? (group && nearest(now, place, seenOf));
    if (next) go(next);
  });
  const release = () => {
    observer.disconnect();
    held = null;
  };
  document.addEventListener("focusin", ({ target }) => {
    release();
    if (!target.matches?.("button")) return;
    const group = target.id ? null : target.closest('[data-paminsa-mark~="row"]') && target.parentElement;
    const row = target.id ? target.parentElement : group?.closest('[data-paminsa-mark~="row"]').parentElement;
    const container = row?.parentElement;
    if (!container) return;
    const rows = [...container.children];
    const index = group ? [...group.children].indexOf(target) : 0;
    held = { button: target, container, rows, place: rows.indexOf(row), group, index };
    observer.observe(container, { childList: true });
    if (group) observer.observe(group, { childList: true });
    observer.observe(target, { attributeFilter: ["disabled"] });
  }, { signal });
  document.addEventListener("pointerdown", ({ target }) => {
    if (!held?.button.contains(target)) release();
  }, { signal, capture: true });
  signal.addEventListener("abort", release);
};
