/**
 * Copies text to the clipboard, and any table of the page by a button that is shown over it.
 *
 * The clipboard of the browser needs a secure context: this machine or TLS. Elsewhere the older way
 * is tried, and where that is refused the text is shown, selected, to be copied by hand.
 */
(() => {
  "use strict";
  window.paminsaClipboard?.stop();
  const stopped = new AbortController();
  const on = (kind, run) => document.addEventListener(kind, run, { signal: stopped.signal });

  const selected = (text, style) => {
    const area = document.createElement("textarea");
    Object.assign(area, { value: text, readOnly: true });
    Object.assign(area.style, style);
    document.body.append(area);
    area.select();
    return area;
  };
  const copy = async (text) => {
    if (window.isSecureContext && navigator.clipboard) {
      try {
        await navigator.clipboard.writeText(text);
        return "copied";
      } catch (error) {
        console.warn(error);
      }
    }
    const before = document.activeElement;
    const hidden = selected(text, { position: "fixed", opacity: 0 });
    const done = document.execCommand("copy");
    hidden.remove();
    before?.focus?.({ preventScroll: true });
    if (done) return "copied";
    const shown = selected(text, {
      position: "fixed", inset: "15% 20%", zIndex: 950, font: "12px monospace",
    });
    shown.setAttribute("aria-label", "Text to copy; Escape closes it");
    shown.focus();
    for (const kind of ["blur", "copy"])
      shown.addEventListener(kind, () => setTimeout(() => shown.remove(), 100));
    shown.addEventListener("keydown", (event) => event.key === "Escape" && shown.remove());
    return "selected";
  };

  // Cells side by side with tabs, as spreadsheets take them; a minus sign becomes a hyphen there.
  const textOf = (table) => [...table.rows]
    .map((row) => [...row.cells].map((cell) => cell.innerText.trim().replace(/\s+/g, " ")
      .replace(/\u2212(?=[\d.])/g, "-")).join("\t"))
    .join("\n");

  let table = null;
  let timer = 0;
  const button = document.createElement("button");
  Object.assign(button, { type: "button", className: "pv-copy", textContent: "Copy", hidden: true });
  button.dataset.testid = "copy-table";
  button.setAttribute("aria-label", "Copy the table");
  document.body.append(button);
  const hide = () => {
    timer = setTimeout(() => (button.hidden = true), 400);
  };
  on("pointerover", (event) => {
    const found = event.target.closest?.(".pv-table");
    if (!found && event.target !== button) {
      if (!button.hidden) hide();
      return;
    }
    clearTimeout(timer);
    if (!found) return;
    table = found;
    const box = found.getBoundingClientRect();
    button.hidden = false;
    button.textContent = "Copy";
    // Over the head of the table, where its first column leaves room.
    button.style.left = `${box.left + Math.min(86, box.width / 4)}px`;
    button.style.top = `${box.top - 3}px`;
  });
  on("scroll", hide);
  button.addEventListener("click", async () => {
    if (!table) return;
    button.textContent = (await copy(textOf(table))) === "copied" ? "Copied" : "Selected";
  });

  const give = async (what, text) => window.paminsa?.send("copied", [what, await copy(text)]);
  const stop = () => {
    stopped.abort();
    button.remove();
  };
  window.paminsaClipboard = { give, stop };
})();
