// Mouse, touch and keys on a plot. Drag: zoom to the range (with shift: move). Wheel: zoom about the cursor. Two fingers:
// zoom and move; one finger sideways: move, up and down: scroll the page. Double click, 0: everything. Arrows, + and -.
"use strict";

function listen(plot) {
  const canvas = plot.canvas, group = plot.group, fingers = new Map();
  const place = e => e.clientX - canvas.getBoundingClientRect().left;
  const inside = p => Math.min(Math.max(p, MARGIN.left), MARGIN.left + plot.width);
  let drag = null, pinch = null;

  canvas.addEventListener("wheel", e => {
    e.preventDefault();
    if (Math.abs(e.deltaX) > Math.abs(e.deltaY)) group.pan(Math.sign(e.deltaX) * 0.08);
    else group.zoom(e.deltaY > 0 ? 1.25 : 0.8, plot.fromX(place(e)));
  }, { passive: false });

  canvas.addEventListener("pointerdown", e => {
    canvas.focus({ preventScroll: true });
    fingers.set(e.pointerId, place(e));
    try { canvas.setPointerCapture(e.pointerId); } catch { /* a made-up pointer */ }
    if (fingers.size === 2) {
      const [p, q] = [...fingers.values()];
      pinch = { a: plot.fromX(p), b: plot.fromX(q) }; drag = plot.selection = null;
    } else if (fingers.size === 1) {
      drag = { from: place(e), move: e.pointerType === "touch" || e.shiftKey, range: group.range.slice() };
    }
  });

  canvas.addEventListener("pointermove", e => {
    const p = place(e);
    if (fingers.has(e.pointerId)) fingers.set(e.pointerId, p);
    group.cursor = plot.fromX(inside(p));
    if (pinch && fingers.size === 2) {
      const [p1, p2] = [...fingers.values()];
      if (Math.abs(p2 - p1) > 8) {
        const k = (pinch.b - pinch.a) / (p2 - p1), start = pinch.a - (p1 - MARGIN.left) * k;
        if (k > 0) group.show([start, start + plot.width * k]);
      }
    } else if (drag && drag.move) {
      const d = (drag.from - p) / plot.width * (drag.range[1] - drag.range[0]);
      group.show([drag.range[0] + d, drag.range[1] + d]);
    } else if (drag) plot.selection = [inside(drag.from), inside(p)];
    group.draw();
  });

  const up = e => {
    fingers.delete(e.pointerId);
    if (fingers.size < 2) pinch = null;
    if (drag && plot.selection && Math.abs(plot.selection[1] - plot.selection[0]) > 5)
      group.show(plot.selection.slice().sort((a, b) => a - b).map(p => plot.fromX(p)));
    drag = plot.selection = null; group.draw();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => { group.cursor = null; group.draw(); });
  canvas.addEventListener("dblclick", () => group.reset());
  canvas.addEventListener("keydown", e => {
    const act = { ArrowLeft: () => group.pan(-0.2), ArrowRight: () => group.pan(0.2), "+": () => group.zoom(0.5), "=": () => group.zoom(0.5),
      "-": () => group.zoom(2), "0": () => group.reset(), Home: () => group.reset() }[e.key];
    if (act) { act(); e.preventDefault(); }
  });
}
