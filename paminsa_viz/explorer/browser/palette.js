/**
 * What is typed into the command palette; `search` selects its box.
 *
 * The server says what a text means as a whole. Its line comes later than the others and has to be
 * selected as the first one then; an Enter before that waits for it.
 *
 * The box comes a moment after the key that opens the palette, later on a busy machine. What is
 * typed till then goes into it: elsewhere letters are keys of commands. As it closes it has the focus
 * still, and Mantine takes no keys of a box: the one that opens it again waits until it has left.
 */
window.paminsaPalette = (config) => {
  "use strict";
  const { retry, send, search, signal } = config;
  const commandLines = () => [...document.querySelectorAll(".mantine-Spotlight-action")];
  const typed = { asked: "", answered: "", enter: false };
  const OPENING_TIME = 10000; // how long keys wait for the box [ms]
  const CLOSING_TIME = 1000; // how long a box may have the focus that closes [ms]
  let early = null; // what was typed before there is a box: {text, enter}
  let leftAt = -Infinity; // when Esc was pressed or a line chosen, which close it [ms]
  const opens = ({ key, ctrlKey, metaKey, shiftKey }) =>
    (ctrlKey || metaKey) && (shiftKey ? /^p$/i : /^k$/i).test(key);
  const closes = (box) => box.closest(".mantine-Spotlight-content")?.style.opacity === "0";
  /** Take what the server says of a text: the label of its line, if it has one. */
  const answer = (text, label) => {
    let left = 50;
    retry(() => {
      if (text !== typed.asked) return true;
      const lines = commandLines();
      const here = !label || lines[0]?.textContent.startsWith(label);
      if (!here && --left > 0) return false;
      if (here && label) for (const line of lines)
        if (line === lines[0]) line.dataset.selected = "true";
        else delete line.dataset.selected;
      typed.answered = text;
      if (typed.enter) (lines.find((line) => line.dataset.selected) ?? lines[0])?.click();
      typed.enter = false;
      return true;
    }, 20);
  };
  const ask = (text) => {
    typed.asked = text;
    typed.enter = false;
    typed.answered = send("typed", text) ? null : text;
  };
  const onSearch = (event) => {
    if (!event.target.matches?.(search)) return;
    if (event.type === "keydown" && opens(event)) reopen(event);
    else if (event.key === "Escape") leftAt = performance.now();
    if (event.type === "input") ask(event.target.value.slice(0, 200));
    else if (event.key === "Enter" && typed.asked !== typed.answered) {
      typed.enter = true;
      event.preventDefault();
      event.stopPropagation();
    }
  };
  for (const kind of ["input", "keydown"])
    document.addEventListener(kind, onSearch, { capture: true, signal });
  document.addEventListener("click", ({ target }) => {
    if (target.closest?.(".mantine-Spotlight-action")) leftAt = performance.now();
  }, { capture: true, signal });

  /** Open the palette again that closes, with what is typed till then. */
  const reopen = (event) => {
    const until = leftAt + CLOSING_TIME;
    if (performance.now() > until) return; // it is open, and stays so
    event.preventDefault();
    const { key, code, ctrlKey, metaKey, shiftKey, target } = event;
    const mine = early = { text: "", enter: false };
    retry(() => {
      if (early !== mine) return true;
      if (document.activeElement === target && performance.now() < until) return false;
      early = null;
      const again = { key, code, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true };
      document.documentElement.dispatchEvent(new KeyboardEvent("keydown", again));
      if (early) Object.assign(early, mine);
      return true;
    }, 10);
  };

  /** Put what was typed early into the box, once it is there. */
  const fill = ({ text, enter }) => {
    const box = document.querySelector(`input${search}`);
    if (!box || closes(box)) return false;
    early = null;
    box.focus();
    if (!text) return true;
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(box, text);
    box.dispatchEvent(new Event("input", { bubbles: true }));
    typed.enter = enter && typed.asked !== typed.answered;
    return true;
  };
  // Mantine has taken the key at the root: the palette opens, or closes again before it is there.
  document.addEventListener("keydown", (event) => {
    if (!opens(event) || !event.defaultPrevented || event.target.matches?.(search)) return;
    ask(""); // lines have their own words again
    const until = performance.now() + OPENING_TIME;
    const mine = early ? null : { text: "", enter: false };
    early = mine;
    retry(() => {
      if (performance.now() > until && early === mine) early = null;
      return !early || early !== mine || fill(early);
    }, 20);
  }, { signal });
  window.addEventListener("keydown", (event) => {
    const { key, ctrlKey, metaKey, altKey, isComposing } = event;
    if (!early || isComposing || ctrlKey || metaKey || altKey) return;
    if (key === "Escape") early = null;
    else if (key === "Enter") early.enter = true;
    else if (key === "Backspace") early.text = early.text.slice(0, -1);
    else if (key.length === 1) Object.assign(early, { text: early.text + key, enter: false });
    else return;
    if (!early) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }, { capture: true, signal });
  return { answer };
};
