/**
 * Names of what viser leaves without one, for screen readers: thumbs and number boxes of sliders,
 * boxes of a pair, pictures, and buttons that are an icon.
 */
(() => {
  "use strict";
  clearInterval(window.paminsaNames);
  const nameless = (element) => !element.getAttribute("aria-label") && !element.labels?.length;
  const set = (element, name) => {
    const text = name?.replace(/\s+/g, " ").trim();
    if (text && element.getAttribute("aria-label") !== text) element.setAttribute("aria-label", text);
  };
  const ICONS = [["search", "Commands"], ["adjust", "Viewer settings"], ["x", "Close"]];

  const nameInputs = () => {
    for (const label of document.querySelectorAll("label[for]")) {
      const row = label.closest(".mantine-Flex-root");
      const fields = row?.querySelectorAll('[role="slider"], input:not([type="hidden"]), textarea');
      const found = [...(fields || [])].filter(nameless);
      const boxes = found.filter((field) => field.matches(".mantine-NumberInput-input"));
      const thumbs = found.some((field) => field.matches('[role="slider"]'));
      for (const field of found) {
        const place = thumbs ? -1 : boxes.indexOf(field);
        const ending = boxes.length > 1 && place >= 0 ? `, ${place + 1} of ${boxes.length}` : "";
        set(field, label.textContent + ending);
      }
    }
  };
  const nameButtons = () => {
    for (const button of document.querySelectorAll("button:not([aria-label]):not([aria-hidden])")) {
      if (button.textContent.trim()) continue;
      if (button.matches(".mantine-Notification-closeButton")) set(button, "Close");
      const icon = button.querySelector("svg")?.getAttribute("class") || "";
      const known = ICONS.find(([part]) => icon.includes(part));
      set(button, known?.[1]);
    }
  };
  const namePictures = () => {
    for (const picture of document.querySelectorAll('[role="tabpanel"] img, div > div > img')) {
      const host = picture.closest("div:has(> div > [data-paminsa-slot])");
      const text = host?.querySelector(".pv-map-caption")?.textContent.replace(/\s+/g, " ").trim();
      if (text && picture.alt !== text) picture.alt = text;
    }
  };
  const name = () => {
    nameInputs();
    nameButtons();
    namePictures();
  };
  name();
  window.paminsaNames = setInterval(name, 700);
})();
