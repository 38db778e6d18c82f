/**
 * Keys that the page takes otherwise: in a box, on a slider or a tab, Esc, and Ctrl+Y.
 *
 * `search` selects the box of the command palette, which has keys of its own.
 */
window.paminsaKeys = (config) => {
  "use strict";
  const { send, search, signal } = config;

  // Mantine's keys are dead in a box. These leave it, which takes what was typed, and then work.
  document.addEventListener("keydown", (event) => {
    const { target, key, code, ctrlKey, metaKey, altKey } = event;
    if (altKey || !(ctrlKey || metaKey) || !/^[ks1-5]$/i.test(key)) return;
    if (!target.matches?.("input, textarea") || target.matches(search)) return;
    event.preventDefault();
    event.stopPropagation();
    target.blur();
    const again = { key, code, ctrlKey, metaKey, bubbles: true, cancelable: true };
    document.documentElement.dispatchEvent(new KeyboardEvent("keydown", again));
  }, { capture: true, signal });

  // Arrow keys would turn the camera as well, which listens at the document.
  document.documentElement.addEventListener("keydown", (event) => {
    const { target, key } = event;
    if (key.startsWith("Arrow") && target.closest?.('[role="slider"], [role="tab"]'))
      event.stopPropagation();
  }, { signal });

  // Esc closes the inspector, where nothing else takes it.
  document.addEventListener("keydown", (event) => {
    const taken = event.defaultPrevented || event.target.closest?.("input, textarea");
    if (event.key === "Escape" && !taken && !document.querySelector('[role="dialog"]'))
      send("escape", null);
  }, { signal });

  // The other key of Redo.
  document.addEventListener("keydown", (event) => {
    const { target, key, ctrlKey, shiftKey, altKey } = event;
    if (!ctrlKey || shiftKey || altKey || key.toLowerCase() !== "y") return;
    if (event.defaultPrevented || target.closest?.("input:not([type=checkbox]), textarea")) return;
    event.preventDefault();
    send("redo", null);
  }, { signal });
};
