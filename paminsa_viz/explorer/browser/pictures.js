/**
 * Pictures that follow a drag, in places `img[data-paminsa-picture]` of texts.
 *
 * viser makes an image of the page anew for each of its pictures, and decodes it twice. Here an
 * image stays, with its last picture until the next is ready; a place that is made again, as in a
 * panel that was folded, gets it back.
 */
(() => {
  "use strict";
  const newest = new Map(); // of a place, the address of its picture
  const show = (image) => {
    const address = newest.get(image.dataset.paminsaPicture);
    if (address && image.getAttribute("src") !== address) image.src = address;
  };
  const set = (place, address) => {
    newest.set(place, address);
    for (const image of document.querySelectorAll("[data-paminsa-picture]")) show(image);
  };
  window.paminsaMarks.watch("[data-paminsa-picture]", show);
  window.paminsaPictures = { set };
})();
