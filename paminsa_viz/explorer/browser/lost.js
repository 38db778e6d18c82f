/** Says so when the server does not answer: viser only dims the page. */
window.paminsaLost = (config) => {
  "use strict";
  const { every, signal } = config;
  const LOST_AFTER = 3000; // [ms]; after a short break viser connects again by itself
  let lostSince = 0;
  let lost = null;
  every(500, () => {
    const connected = window.paminsaNumberFields?.connected();
    if (connected !== false) {
      lostSince = 0;
      lost?.remove();
      lost = null;
      return;
    }
    lostSince ||= performance.now();
    if (lost || performance.now() - lostSince < LOST_AFTER) return;
    lost = document.createElement("div");
    lost.className = "pv-lost";
    lost.setAttribute("role", "alert");
    lost.dataset.testid = "lost";
    lost.textContent = "paminsa-viz does not answer: it was stopped, or the connection is lost. "
      + "The page goes on by itself once it runs again; what is set is kept in this tab.";
    document.body.append(lost);
  });
  signal.addEventListener("abort", () => lost?.remove());
};
