/**
 * Hides viser's square for a background image, which is drawn into every picture of the scene and
 * without a graphics card takes as long as the robot; page.css draws the background instead.
 */
(() => {
  const hide = (attempts) => {
    const material = window.__viserMutable?.backgroundMaterial;
    if (material) material.visible = false;
    else if (attempts > 0) setTimeout(hide, 200, attempts - 1);
  };
  hide(300);
})();
