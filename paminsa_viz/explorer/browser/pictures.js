/**
 * Pictures that follow a drag, in places `img[data-paminsa-picture]` of texts.
 *
 * viser makes an image of the page anew for each of its pictures, and decodes it twice. Here an
 * image stays, with its last picture until the next is ready; a place that is made again, as in a
 * panel that was folded, gets it back. The picture comes as the content of a text: texts do not wait
 * for the next drawing of the 3D view, as calls of functions do, and ask for none.
 */
(() => {
  "use strict";
  const newest = new Map(); // of a place, the address of its picture
  const show = (image) => {
    const address = newest.get(image.dataset.paminsaPicture);
    if (address && image.getAttribute("src") !== address) image.src = address;
  };
  window.paminsaMarks.watch("[data-paminsa-picture]", show);
  window.paminsaMarks.watch("[data-paminsa-address]", ({ dataset }) => {
    newest.set(dataset.paminsaPlace, dataset.paminsaAddress);
    for (const image of document.querySelectorAll("[data-paminsa-picture]")) show(image);
  });
})();
