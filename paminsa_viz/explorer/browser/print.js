/**
 * Prints the page as it is on the screen, on one sheet: on paper of another shape the docks would
 * cover a part of the view, whose picture has a size of its own.
 */
window.addEventListener("beforeprint", () => {
  const [width, height] = [window.innerWidth, window.innerHeight];
  const sheet = document.getElementById("paminsa-print") ?? document.createElement("style");
  sheet.id = "paminsa-print";
  sheet.media = "print";
  // A pixel less than the sheet: rounding would begin another one.
  sheet.textContent = `@page { size: ${width}px ${height}px; margin: 0; }
    html, body { height: ${height - 1}px !important; overflow: hidden !important; }
    * { print-color-adjust: exact; }`;
  document.head.append(sheet);
});
