/**
 * The focus of a button that is pressed and goes: where a task runs, the button that stops it stands
 * there, and at the end the first one again. Some only cannot be pressed meanwhile.
 *
 * Left alone, the focus would be nowhere, and who has no mouse would not know where they are.
 */
window.paminsaFocus = (config) => {
  "use strict";
  const { signal } = config;
  let held = null; // the button that has the focus, or had it: {button, rows, place}
  const isFree = () => [null, document.body].includes(document.activeElement);
  const buttonOf = (row) => row.querySelector(":scope > button[id]:enabled");
  const go = (button) => button.focus({ preventScroll: true });
  const observer = new MutationObserver((changes) => {
    if (!held || !isFree()) return;
    const { button, rows, place } = held;
    if (button.isConnected) return button.disabled ? undefined : go(button);
    const container = changes.find(({ type }) => type === "childList")?.target;
    const now = [...(container?.children ?? [])];
    const far = (row) => Math.abs(now.indexOf(row) - place);
    const [next] = now.filter((row) => !rows.includes(row) && buttonOf(row))
      .sort((one, other) => far(one) - far(other));
    if (next) go(buttonOf(next));
  });
  const release = () => {
    observer.disconnect();
    held = null;
  };
  document.addEventListener("focusin", ({ target }) => {
    release();
    const row = target.matches?.("button[id]") && target.parentElement;
    const container = row?.parentElement;
    if (!container) return;
    const rows = [...container.children];
    held = { button: target, rows, place: rows.indexOf(row) };
    observer.observe(container, { childList: true });
    observer.observe(target, { attributeFilter: ["disabled"] });
  }, { signal });
  document.addEventListener("pointerdown", ({ target }) => {
    if (!held?.button.contains(target)) release();
  }, { signal, capture: true });
  signal.addEventListener("abort", release);
};
