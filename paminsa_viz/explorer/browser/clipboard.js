/**
 * Copies text to the clipboard, and any table of the page by a button that is shown beside it.
 *
 * The clipboard of the browser needs a secure context: this machine or TLS. Elsewhere the older way
 * is tried. Safari refuses both for a text that comes from the server, after the press that asked for
 * it: where a text is refused, it is shown with a button that copies it.
 */
(() => {
  "use strict";
  window.paminsaClipboard?.stop();
  const stopped = new AbortController();
  const on = (kind, run) => document.addEventListener(kind, run, { signal: stopped.signal });

  const selected = (text, parent) => {
    const area = document.createElement("textarea");
    Object.assign(area, { value: text, readOnly: true });
    parent.append(area);
    area.select();
    return area;
  };
  let closeOffer = () => {};
  /** Show a text with a button that copies it, and call a function once it is copied. */
  const offer = (text, taken) => {
    closeOffer();
    const box = document.createElement("div");
    box.className = "pv-to-copy";
    box.setAttribute("role", "dialog");
    box.setAttribute("aria-label", "Text to copy; Escape closes it");
    document.body.append(box);
    const area = selected(text, box);
    area.setAttribute("aria-label", "Text to copy");
    const press = document.createElement("button");
    Object.assign(press, { type: "button", textContent: "Copy" });
    box.append(press);
    const closed = new AbortController();
    closeOffer = () => {
      closed.abort();
      box.remove();
    };
    const { signal } = closed;
    press.addEventListener("click", () => {
      area.select();
      document.execCommand("copy");
    });
    box.addEventListener("copy", () => setTimeout(() => {
      closeOffer();
      taken();
    }));
    box.addEventListener("keydown", (event) => {
      event.stopPropagation(); // the page's own keys are for the page
      if (event.key === "Escape") closeOffer();
    });
    // Not by the focus: in Safari a button that is pressed takes it from the text and does not get it.
    window.addEventListener("pointerdown", ({ target }) => box.contains(target) || closeOffer(), {
      capture: true, signal,
    });
  };
  const copy = async (text, taken) => {
    if (window.isSecureContext && navigator.clipboard) {
      try {
        await navigator.clipboard.writeText(text);
        return "copied";
      } catch (error) {
        console.warn(error);
      }
    }
    const before = document.activeElement;
    const hidden = selected(text, document.body);
    Object.assign(hidden.style, { position: "fixed", opacity: 0 });
    const done = document.execCommand("copy");
    hidden.remove();
    before?.focus?.({ preventScroll: true });
    if (done) return "copied";
    offer(text, taken);
    return "offered";
  };

  // Cells side by side with tabs, as spreadsheets take them; a minus sign becomes a hyphen there.
  const hasText = (cell) => !cell.querySelector(":scope > .pv-unpin");
  const textOf = (table) => [...table.rows]
    .map((row) => [...row.cells].filter(hasText).map((cell) => cell.innerText.trim()
      .replace(/\s+/g, " ").replace(/\u2212(?=[\d.])/g, "-")).join("\t"))
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
    const say = (what) => { button.textContent = what === "copied" ? "Copied" : "Copy"; };
    if (table) say(await copy(textOf(table), () => say("copied")));
  });

  const give = async (what, text) => {
    const tell = (how) => window.paminsa?.send("copied", [what, how]);
    tell(await copy(text, () => tell("copied")));
  };
  const stop = () => {
    closeOffer();
    stopped.abort();
    button.remove();
  };
  window.paminsaClipboard = { give, stop };
})();
