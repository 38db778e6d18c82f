"use strict";
(() => {
  const data = JSON.parse(document.getElementById("motion-data").textContent);
  const find = (name) => document.getElementById(`motion-${name}`);
  const numbers = (text) =>
    new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const positions = numbers(data.positions);
  const turns = numbers(data.turns);
  const torques = numbers(data.torques);

  /** How long the scene may take to appear before the numbers go on without it [ms]. */
  const DRAW_TIMEOUT = 20000;

  const slider = find("time");
  slider.max = data.duration;
  let time = 0;
  let playing = true;
  let last = null;
  let drawn = null;

  /** Value `column` of `width` a frame, between the frames around the present time. */
  function sampler(view, width) {
    const place = (time / data.duration) * (data.frames - 1);
    const left = Math.min(Math.floor(place), data.frames - 2);
    const share = place - left;
    const at = (frame, column) => view.getFloat32(4 * (frame * width + column), true);
    return { share, ends: (column) => [at(left, column), at(left + 1, column)] };
  }

  function positionOf(sample, index) {
    return [0, 1, 2].map((k) => {
      const [a, b] = sample.ends(3 * index + k);
      return a + sample.share * (b - a);
    });
  }

  /** Quaternions are mixed along the shorter way: q and -q are the same turn. */
  function turnOf(sample, index) {
    const pairs = [0, 1, 2, 3].map((k) => sample.ends(4 * index + k));
    const sign = pairs.reduce((sum, [a, b]) => sum + a * b, 0) < 0 ? -1 : 1;
    const mixed = pairs.map(([a, b]) => a + sample.share * (sign * b - a));
    const size = Math.hypot(...mixed);
    return mixed.map((value) => value / size);
  }

  /** Move the nodes; false while the scene is still being made. */
  function draw() {
    const { nodePoseData: poses, nodeRefFromName: nodes, requestRender } = window.__viserMutable || {};
    if (!poses || !nodes || !requestRender) return false;
    const names = [...data.moved, ...data.turned];
    if (!names.every((name) => poses[name] && nodes[name])) return false;
    const moved = sampler(positions, 3 * data.moved.length);
    data.moved.forEach((name, i) => { poses[name].position = positionOf(moved, i); });
    const turned = sampler(turns, 4 * data.turned.length);
    data.turned.forEach((name, i) => { poses[name].wxyz = turnOf(turned, i); });
    for (const name of names) {
      if (poses[name].poseUpdateState !== "waitForMakeObject") {
        poses[name].poseUpdateState = "needsUpdate";
      }
    }
    requestRender();
    return true;
  }

  const readings = data.colors.map((color) => {
    const reading = document.createElement("span");
    reading.style.color = color;
    find("torques").append(reading);
    return reading;
  });

  function showNumbers() {
    slider.value = time;
    find("clock").value = `${time.toFixed(2)} / ${data.duration.toFixed(2)} s`;
    const sample = sampler(torques, 4);
    readings.forEach((reading, j) => {
      const [a, b] = sample.ends(j);
      const value = (a + sample.share * (b - a)).toFixed(j < 3 ? 2 : 1).replace("-", "−");
      reading.textContent = `M${j + 1}  ${value} ${j < 3 ? "N·m" : "N"}`;
    });
  }

  function play(on) {
    if (on && !playing && time >= data.duration) time = 0;
    playing = on;
    last = null;
    find("play").setAttribute("aria-label", on ? "Stop" : "Play");
  }

  let waited = 0;
  function step(now) {
    const passed = last === null ? 0 : ((now - last) / 1000) * Number(find("speed").value);
    if (playing && drawn !== null) {
      last = now;
      if (time + passed < data.duration) {
        time += passed;
      } else if (time < data.duration) {
        time = data.duration;
        waited = 0;
      } else if (!find("loop").checked) {
        play(false);
      } else if ((waited += passed) >= data.pause) {
        time = 0;
      }
    }
    if (time !== drawn && (draw() || now > DRAW_TIMEOUT)) {
      drawn = time;
      showNumbers();
    }
    requestAnimationFrame(step);
  }

  function seek(to) {
    play(false);
    time = Math.min(Math.max(to, 0), data.duration);
  }

  find("play").addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => seek(Number(slider.value)));
  window.addEventListener("keydown", (event) => {
    if (event.code !== "Space" || event.target.closest("button, select, input")) return;
    event.preventDefault();
    play(!playing);
  });
  requestAnimationFrame(step);
})();
