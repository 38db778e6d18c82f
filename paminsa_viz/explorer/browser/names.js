/**
 * Names of what viser leaves without one, for screen readers: thumbs and number boxes of sliders,
 * boxes of a pair, pictures, and buttons that are an icon. By their names they get the focus. What
 * comes without being looked at is said.
 */
(() => {
  "use strict";
  const { watch } = window.paminsaMarks;
  const named = new WeakSet(); // what has its name from here
  const nameless = (element) =>
    named.has(element) || (!element.getAttribute("aria-label") && !element.labels?.length);
  const plain = (text) => text?.replace(/\s+/g, " ").trim();
  const set = (element, name) => {
    const text = plain(name);
    if (!text) return;
    named.add(element);
    if (element.getAttribute("aria-label") !== text) element.setAttribute("aria-label", text);
  };

  const ROW = '[data-paminsa-mark~="row"]';
  const FIELD = '[role="slider"], input:not([type="hidden"]), textarea';
  const BOX = ".mantine-NumberInput-input";
  const nameFields = (label) => {
    const found = [...(label.closest(ROW)?.querySelectorAll(FIELD) || [])].filter(nameless);
    const boxes = found.filter((field) => field.matches(BOX));
    const thumbs = found.some((field) => field.matches('[role="slider"]'));
    for (const field of found) {
      const place = thumbs ? -1 : boxes.indexOf(field);
      const ending = boxes.length > 1 && place >= 0 ? `, ${place + 1} of ${boxes.length}` : "";
      set(field, label.textContent + ending);
    }
  };
  watch("label[for]", nameFields);
  watch(FIELD, (field) => {
    const label = field.closest(ROW)?.querySelector("label[for]");
    if (label) nameFields(label);
  });

  /**
   * Put the focus into the first field whose label begins with one of `names` and whose section is
   * open. Fields of a section that is being opened are waited for; a folder around it is opened.
   */
  const focus = (names) => {
    const opened = new Set();
    const begins = (label) => names.some((name) => plain(label.textContent).startsWith(name));
    const seen = (element) => Boolean(element?.getClientRects().length);
    const CHEVRON = ":scope > [class*=tabler-icon-chevron]";
    const shut = (body) =>
      body.style.overflow === "hidden" && body.previousElementSibling?.querySelector(CHEVRON);
    const shutAround = (row) => {
      const found = [];
      for (let body = row; body; body = body.parentElement) if (shut(body)) found.push(body);
      return found;
    };
    const unfold = (row) => {
      const heads = shutAround(row).map((body) => body.previousElementSibling);
      const head = heads.find((one) => seen(one) && !opened.has(one));
      if (!head) return;
      opened.add(head);
      head.click();
    };
    const attempt = (left) => {
      const labels = [...document.querySelectorAll("label[for]")].filter(begins);
      const rows = labels.map((label) => label.closest(ROW)).filter(Boolean);
      const row = rows.find((one) => seen(one) && !shutAround(one).length);
      const field = row?.querySelector(BOX) ?? row?.querySelector(FIELD);
      if (!field && left > 0) {
        if (!rows.some(seen)) rows.forEach(unfold);
        setTimeout(attempt, 50, left - 1);
      }
      field?.scrollIntoView({ block: "nearest" });
      field?.focus({ preventScroll: true });
      field?.select?.();
    };
    attempt(60);
  };

  // What a screen reader says of what comes elsewhere on the page; the same again is said again.
  const SPOKEN = "pv-spoken";
  const spoken = document.querySelector(`.${SPOKEN}`) ?? document.createElement("div");
  spoken.className = SPOKEN;
  spoken.setAttribute("role", "status");
  document.body.append(spoken);
  const say = (text) => {
    spoken.textContent = "";
    setTimeout(() => { spoken.textContent = text; }, 100);
  };
  window.paminsaNames = { focus, say };

  const ICONS = [["search", "Commands"], ["adjust", "Viewer settings"], ["x", "Close"]];
  watch("button:not([aria-label]):not([aria-hidden])", (button) => {
    if (button.textContent.trim()) return;
    if (button.matches(".mantine-Notification-closeButton")) set(button, "Close");
    const icon = button.querySelector("svg")?.getAttribute("class") || "";
    set(button, ICONS.find(([part]) => icon.includes(part))?.[1]);
  });

  // A picture is named by its caption, which changes with every frame of a drag.
  let timer = 0;
  const namePictures = () => {
    timer = 0;
    for (const caption of document.querySelectorAll(".pv-map-caption"))
      for (const picture of caption.parentElement.parentElement.querySelectorAll("img"))
        if (picture.alt !== plain(caption.textContent)) picture.alt = plain(caption.textContent);
  };
  watch(".pv-map-caption, img", () => { timer ||= setTimeout(namePictures, 700); });
})();
