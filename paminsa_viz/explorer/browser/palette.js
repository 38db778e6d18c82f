/**
 * What is typed into the command palette; `search` selects its box.
 *
 * The server says what a text means as a whole. Its line comes later than the others and has to be
 * selected as the first one then; an Enter before that waits for it.
 */
window.paminsaPalette = (config) => {
  "use strict";
  const { retry, send, search, signal } = config;
  const commandLines = () => [...document.querySelectorAll(".mantine-Spotlight-action")];
  const typed = { asked: "", answered: "", enter: false };
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
  const onSearch = (event) => {
    if (!event.target.matches?.(search)) return;
    if (event.type === "input") {
      typed.asked = event.target.value.slice(0, 200);
      typed.enter = false;
      if (!send("typed", typed.asked)) typed.answered = typed.asked;
    } else if (event.key === "Enter" && typed.asked !== typed.answered) {
      typed.enter = true;
      event.preventDefault();
      event.stopPropagation();
    }
  };
  for (const kind of ["input", "keydown"])
    document.addEventListener(kind, onSearch, { capture: true, signal });
  return { answer };
};
