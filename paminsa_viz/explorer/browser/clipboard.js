/**
 * Copies text to the clipboard, and any table of the page by a button that is shown beside it.
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
    timer ||= setTimeout(() => {
      timer = 0;
      button.hidden = true;
    }, 900);
  };
  // In the 3D view, next to the panel that the table is in, and so over no text; over the table
  // where there is no view beside it.
  const place = (box) => {
    const view = window.__viserMutable?.canvas?.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = button;
    let [x, y] = [box.right - width, box.top - height];
    if (view && box.left >= view.right - 1) [x, y] = [view.right - width - 5, box.top];
    else if (view && box.right <= view.left + 1) [x, y] = [view.left + 5, box.top];
    button.style.left = `${Math.max(x, 2)}px`;
    button.style.top = `${Math.max(Math.min(y, window.innerHeight - height), 2)}px`;
  };
  on("pointerover", (event) => {
    const found = event.target.closest?.(".pv-table");
    if (!found && event.target !== button) {
      if (!button.hidden) hide();
      return;
    }
    clearTimeout(timer);
    timer = 0;
    if (!found) return;
    table = found;
    button.hidden = false;
    button.textContent = "Copy";
    place(found.getBoundingClientRect());
  });
  document.addEventListener("scroll", hide, { capture: true, signal: stopped.signal });
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
