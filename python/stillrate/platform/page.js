// The platform against its base: one slider moves every drawing and the cursor in the curves of the same motion.
"use strict";
(() => {
  const find = (id) => document.getElementById(id);
  const motions = JSON.parse(find("motion").textContent);
  const slider = find("time"), play = find("play"), clock = find("clock"), choice = find("choice");
  const stages = [...document.querySelectorAll(".stage figure")].map((figure) => ({
    base: figure.querySelector(".base"), top: figure.querySelector(".top"), read: figure.querySelector(".read"),
  }));
  let motion = motions[0], at = 0, last = 0, running = false;

  const turned = (angle) => `rotate(${-angle} 0 -30)`;

  function draw() {
    const k = Math.min(Math.round(at / motion.dt), motion.base.length - 1);
    slider.value = k;
    clock.textContent = `${(k * motion.dt).toFixed(2)} s`;
    stages.forEach((stage, i) => {
      stage.base.setAttribute("transform", turned(motion.base[k]));
      stage.top.setAttribute("transform", turned(motion.angles[i][k]));
      stage.read.textContent = `${motion.angles[i][k].toFixed(2)} deg`;
    });
    document.querySelectorAll(".cursor").forEach((line) => {
      const mine = line.dataset.motion === motion.name;
      line.setAttribute("visibility", mine ? "visible" : "hidden");
      const x = +line.dataset.left + (k * motion.dt / +line.dataset.seconds) * +line.dataset.width;
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
    });
  }

  function choose(index) {
    motion = motions[index];
    at = 0;
    slider.max = motion.base.length - 1;
    draw();
  }

  function tick(now) {
    if (!running) return;
    at += Math.max(now - last, 0) / 1000;
    last = now;
    if (at > motion.dt * (motion.base.length - 1)) at = 0;
    draw();
    requestAnimationFrame(tick);
  }

  play.addEventListener("click", () => {
    running = !running;
    play.textContent = running ? "Pause" : "Play";
    last = performance.now();
    if (running) requestAnimationFrame(tick);
  });
  slider.addEventListener("input", () => { at = slider.value * motion.dt; draw(); });
  choice?.addEventListener("change", () => choose(choice.selectedIndex));
  choose(0);
})();
