/**
 * Files that the page does not send: one that is larger than the server takes, and one that is
 * dropped on the page, which a browser would open in its place.
 *
 * A large one would be sent in full before the server could say so, and a very large one would cost
 * the connection. `largest` is what the server takes [bytes].
 */
window.paminsaFiles = (config) => {
  "use strict";
  const { largest, send, signal } = config;
  const options = { capture: true, signal };
  document.addEventListener("change", (event) => {
    const { target } = event;
    const file = target.matches?.('input[type="file"]') && target.files[0];
    if (!file || file.size <= largest) return;
    event.stopPropagation(); // viser would begin to send it
    target.value = ""; // so that the same name can be chosen again
    send("refused file", [file.name, "large"]);
  }, options);
  const holdsFiles = ({ dataTransfer }) => dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (event) => holdsFiles(event) && event.preventDefault(), options);
  document.addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    send("refused file", [event.dataTransfer.files[0]?.name ?? "", "dropped"]);
  }, options);
};
