/**
 * Names of what viser leaves without one, for screen readers: thumbs and number boxes of sliders,
 * boxes of a pair, pictures, and buttons that are an icon. By their names they get the focus.
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
   * Put the focus into the first field that is seen and whose label begins with one of `names`;
   * fields of a section that is being opened are waited for.
   */
  const focus = (names, tries = 60) => {
    const begins = (label) => names.some((name) => plain(label.textContent).startsWith(name));
    const labels = [...document.querySelectorAll("label[for]")].filter(begins);
    const rows = labels.map((label) => label.closest(ROW)).filter((row) => row?.getClientRects().length);
    const field = rows[0]?.querySelector(BOX) ?? rows[0]?.querySelector(FIELD);
    if (!field && tries > 0) setTimeout(focus, 50, names, tries - 1);
    field?.scrollIntoView({ block: "nearest" });
    field?.focus({ preventScroll: true });
    field?.select?.();
  };
  window.paminsaNames = { focus };

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
