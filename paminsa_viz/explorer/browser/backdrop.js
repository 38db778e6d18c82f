/**
 * Hides viser's square for a background image, which is drawn into every picture of the scene and
 * without a graphics card takes as long as the robot; view.css draws the background instead.
 */
(() => {
  const hide = () => {
    const material = window.__viserMutable?.backgroundMaterial;
    if (material) material.visible = false;
    else setTimeout(hide, 200);
  };
  hide();
})();
