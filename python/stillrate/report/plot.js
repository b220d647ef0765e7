// One plot on a canvas: lines over a linear or logarithmic axis, drawn from all samples. Where a pixel column holds many
// samples it shows their extent, where samples stand apart each is a dot. Plots of one group share their x range.
"use strict";

class Group {
  constructor() { this.plots = []; this.full = null; this.range = null; this.cursor = null; }
  show(range) {
    const [low, high] = this.full, least = this.least || (high - low) * 1e-9;
    const span = Math.min(Math.max(range[1] - range[0], least), high - low);
    let start = Math.min(Math.max(range[0], low), high - span);
    this.range = [start, start + span];
    this.draw();
  }
  zoom(factor, at) {
    const [a, b] = this.range, centre = at === undefined ? (a + b) / 2 : at;
    this.show([centre - (centre - a) * factor, centre + (b - centre) * factor]);
  }
  pan(part) { const [a, b] = this.range, d = (b - a) * part; this.show([a + d, b + d]); }
  reset() { this.show(this.full); }
  draw() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => { this.pending = 0; this.plots.forEach(plot => plot.draw()); });
  }
}

const MARGIN = { left: 58, right: 10, top: 8, bottom: 22 };
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const short = v => !isFinite(v) ? "–" : v === 0 ? "0" : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-4
  ? v.toExponential(2) : String(+v.toPrecision(5));

class Plot {
  // holder: the element it fills. options: title, height, xUnit; logX (x is given as log10), logY (y is not), fixed (range of y),
  // marks (gives what stands at the foot), count (the readout names the sample), points (each series is one point).
  constructor(holder, group, options) {
    this.group = group; this.options = options; this.series = []; this.hidden = new Set();
    const make = (tag, kind) => { const e = document.createElement(tag); e.className = kind; holder.append(e); return e; };
    this.title = make("h3", "title"); this.title.textContent = options.title;
    this.legend = make("div", "legend");
    this.canvas = make("canvas", "plot"); this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img"); this.canvas.setAttribute("aria-label", options.title);
    this.canvas.style.height = (options.height || 220) + "px";
    this.readout = make("div", "readout");
    group.plots.push(this);
    listen(this);
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  // series: [{name, colour, x: ascending, y, wide, dash, dots, label}]; what is not finite is a gap.
  set(series) {
    this.series = series;
    this.legend.replaceChildren(...(this.options.points ? [] : series).map(s => {
      const b = document.createElement("button");
      b.textContent = s.name; b.style.setProperty("--c", css(s.colour)); b.setAttribute("aria-pressed", "true");
      b.classList.toggle("dashed", Boolean(s.dash && s.dash.length));
      b.onclick = () => {
        this.hidden.has(s.name) ? this.hidden.delete(s.name) : this.hidden.add(s.name);
        b.setAttribute("aria-pressed", String(!this.hidden.has(s.name))); this.draw();
        if (this.toggled) this.toggled();
      };
      if (this.hidden.has(s.name)) b.setAttribute("aria-pressed", "false");
      return b;
    }));
    this.draw();
  }

  toX(v) { const [a, b] = this.group.range; return MARGIN.left + (v - a) / (b - a) * this.width; }
  fromX(p) { const [a, b] = this.group.range; return a + (p - MARGIN.left) / this.width * (b - a); }
  toY(v) { const [a, b] = this.yRange; return MARGIN.top + this.height - (v - a) / (b - a) * this.height; }
  get shown() { return this.series.filter(s => !this.hidden.has(s.name)); }

  // First index whose x is not below the value (x ascends).
  find(s, value) {
    let low = 0, high = s.y.length;
    while (low < high) { const mid = (low + high) >> 1; if (s.x[mid] < value) low = mid + 1; else high = mid; }
    return low;
  }
  window(s) {
    const [a, b] = this.group.range;
    return [Math.max(0, this.find(s, a) - 1), Math.min(s.y.length, this.find(s, b) + 1)];
  }
  value(v) { return this.options.logY ? (v > 0 ? Math.log10(v) : NaN) : v; }

  fit() {
    if (this.options.fixed) { this.yRange = this.options.fixed; return; }
    let low = Infinity, high = -Infinity;
    for (const s of this.shown) {
      const [from, to] = this.window(s);
      for (let i = from; i < to; i++) { const v = this.value(s.y[i]); if (v < low) low = v; if (v > high) high = v; }
    }
    if (!(low <= high)) { low = 0; high = 1; }
    const margin = (high - low) * 0.06 || Math.abs(high) * 0.1 || 1;
    this.yRange = [low - margin, high + margin];
  }

  draw() {
    const box = this.canvas.getBoundingClientRect(), scale = devicePixelRatio || 1;
    if (!box.width || !this.group.range) return;
    if (this.canvas.width !== Math.round(box.width * scale)) this.canvas.width = Math.round(box.width * scale);
    if (this.canvas.height !== Math.round(box.height * scale)) this.canvas.height = Math.round(box.height * scale);
    this.width = box.width - MARGIN.left - MARGIN.right; this.height = box.height - MARGIN.top - MARGIN.bottom;
    const c = this.canvas.getContext("2d");
    c.setTransform(scale, 0, 0, scale, 0, 0); c.clearRect(0, 0, box.width, box.height);
    this.fit(); this.axes(c);
    c.save(); c.beginPath(); c.rect(MARGIN.left, MARGIN.top, this.width, this.height); c.clip();
    for (const s of this.shown) this.line(c, s);
    this.labels(c);
    this.marks(c);
    c.restore();
    this.cursor(c);
    this.canvas.dataset.drawn = "1";
  }

  line(c, s) {
    const [from, to] = this.window(s);
    c.strokeStyle = c.fillStyle = css(s.colour); c.lineWidth = s.wide || 1.25; c.lineJoin = "round";
    c.setLineDash(s.dash || []); c.beginPath();
    if (to - from > 3 * this.width) { c.setLineDash([]); this.extent(c, s, from, to); return; }
    let pen = false;
    for (let i = from; i < to; i++) {
      const v = this.value(s.y[i]);
      if (!isFinite(v)) { pen = false; continue; }
      const x = this.toX(s.x[i]), y = this.toY(v);
      pen ? c.lineTo(x, y) : c.moveTo(x, y); pen = true;
    }
    c.stroke(); c.setLineDash([]);
    if ((to - from) * 7 < this.width || s.dots) {
      c.beginPath();
      for (let i = from; i < to; i++) {
        const v = this.value(s.y[i]);
        if (isFinite(v)) { const x = this.toX(s.x[i]), y = this.toY(v), r = s.label ? 4 : 2.2; c.moveTo(x + r, y); c.arc(x, y, r, 0, 7); }
      }
      c.fill();
    }
  }

  // Names beside single points, each where it covers no other name and no point.
  labels(c) {
    const points = this.shown.filter(s => s.label).map(s => ({ s, x: this.toX(s.x[0]), y: this.toY(this.value(s.y[0])) }));
    const taken = points.map(p => [p.x - 5, p.y - 5, p.x + 5, p.y + 5]);
    c.font = `${this.width < 500 ? 10 : 12}px system-ui, sans-serif`; c.textBaseline = "middle"; c.textAlign = "left";
    for (const p of points) {
      const wide = c.measureText(p.s.name).width, free = [];
      for (const reach of [8, 20, 34, 52, 74])
        for (const [side, up] of [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -0.8], [1, 0.8], [-1, -0.8], [-1, 0.8], [0.5, 1], [0.5, -1]]) {
          const x = p.x + side * reach - (side < 0 ? wide : side ? 0 : wide / 2), y = p.y + up * (reach + 6);
          free.push([x, y - 7, x + wide, y + 7]);
        }
      const inside = b => b[0] > MARGIN.left && b[2] < MARGIN.left + this.width && b[1] > MARGIN.top && b[3] < MARGIN.top + this.height;
      const clear = b => taken.every(t => b[2] < t[0] || b[0] > t[2] || b[3] < t[1] || b[1] > t[3]);
      const box = free.find(b => inside(b) && clear(b));
      if (!box) continue; // The readout names it.
      taken.push(box); p.box = box;
    }
    c.lineWidth = 1; c.strokeStyle = css("--ink"); c.globalAlpha = 0.45;
    for (const { x, y, box } of points.filter(p => p.box)) {
      const [endX, endY] = [Math.max(box[0] - 2, Math.min(x, box[2] + 2)), Math.max(box[1] + 1, Math.min(y, box[3] - 1))];
      const far = Math.hypot(endX - x, endY - y);
      if (far < 14) continue;
      c.beginPath(); c.moveTo(x + (endX - x) * 5 / far, y + (endY - y) * 5 / far); c.lineTo(endX, endY); c.stroke();
    }
    c.globalAlpha = 1; c.fillStyle = css("--strong");
    for (const { s, box } of points.filter(p => p.box)) c.fillText(s.name, box[0], (box[1] + box[3]) / 2);
  }

  // Many samples a pixel: a stroke from the least to the greatest of each pixel column.
  extent(c, s, from, to) {
    let column = -1, low = 0, high = 0, before = 0;
    const [a, b] = this.group.range, k = this.width / (b - a), flush = () => {
      if (column < 0) return;
      const top = this.toY(high), bottom = this.toY(low);
      c.moveTo(column + MARGIN.left + 0.5, top - 0.6); c.lineTo(column + MARGIN.left + 0.5, bottom + 0.6);
    };
    for (let i = from; i < to; i++) {
      const v = this.value(s.y[i]);
      if (v !== v) { before = v; continue; }
      const p = ((s.x[i] - a) * k) | 0;
      if (p !== column) {
        const last = column < 0 ? v : (high + low) / 2, next = p === column + 1;
        flush();
        // On a logarithmic axis samples may be many in one place and pixels apart in another.
        if (column >= 0 && !next && before === before) { c.moveTo(column + MARGIN.left + 0.5, this.toY(before)); c.lineTo(p + MARGIN.left + 0.5, this.toY(v)); }
        column = p; low = next ? Math.min(v, last) : v; high = next ? Math.max(v, last) : v;
      } else { if (v < low) low = v; if (v > high) high = v; }
      before = v;
    }
    flush(); c.stroke();
  }

  marks(c) {
    for (const m of this.options.marks ? this.options.marks() : []) {
      c.fillStyle = css(m.colour);
      let last = -9;
      for (const at of m.x) {
        const x = this.toX(at);
        if (x < MARGIN.left - 1 || x > MARGIN.left + this.width + 1 || x - last < 1) continue;
        c.fillRect(x - 0.75, MARGIN.top + this.height - 7, 1.5, 7); last = x;
      }
    }
    if (this.selection) {
      const [x1, x2] = this.selection; c.fillStyle = css("--pick");
      c.fillRect(Math.min(x1, x2), MARGIN.top, Math.abs(x2 - x1), this.height);
    }
  }

  axes(c) {
    const ink = css("--ink"), faint = css("--line");
    c.font = "11px system-ui, sans-serif"; c.lineWidth = 1;
    const [a, b] = this.group.range, [low, high] = this.yRange;
    const put = (v, text, along) => {
      c.strokeStyle = faint; c.fillStyle = ink; c.beginPath();
      if (along) {
        const x = this.toX(v); c.moveTo(x, MARGIN.top); c.lineTo(x, MARGIN.top + this.height); c.stroke();
        c.textAlign = "center"; c.textBaseline = "top";
        if (x < MARGIN.left + this.width - 30) c.fillText(text, x, MARGIN.top + this.height + 5);
      } else {
        const y = this.toY(v); c.moveTo(MARGIN.left, y); c.lineTo(MARGIN.left + this.width, y); c.stroke();
        c.textAlign = "right"; c.textBaseline = "middle"; c.fillText(text, MARGIN.left - 5, y);
      }
    };
    for (const t of this.options.logX ? decades(a, b, this.width / 60) : ticks(a, b, this.width / 80)) put(...t, true);
    for (const t of this.options.logY ? decades(low, high, this.height / 24) : ticks(low, high, this.height / 36)) put(...t, false);
    c.fillStyle = ink; c.textAlign = "right"; c.textBaseline = "top";
    c.fillText(this.options.xUnit, MARGIN.left + this.width, MARGIN.top + this.height + 5);
  }

  cursor(c) {
    const at = this.group.cursor;
    if (at === null || at < this.group.range[0] || at > this.group.range[1]) { this.readout.textContent = "\u00a0"; return; }
    const x = this.toX(at);
    c.strokeStyle = css("--ink"); c.globalAlpha = 0.4; c.beginPath(); c.moveTo(x, MARGIN.top);
    c.lineTo(x, MARGIN.top + this.height); c.stroke(); c.globalAlpha = 1;
    const words = [];
    if (this.options.points) { this.readout.textContent = this.nearest(at); return; }
    for (const s of this.shown) {
      let i = this.find(s, at);
      if (i > 0 && (i >= s.y.length || at - s.x[i - 1] < s.x[i] - at)) i--;
      if (i < s.y.length) {
        if (!words.length) words.push(`${short(this.options.logX ? 10 ** s.x[i] : s.x[i])} ${this.options.xUnit}` + (this.options.count ? ` (sample ${i})` : ""));
        words.push(`${s.name} ${short(s.y[i])}`);
      }
    }
    this.readout.textContent = words.join("   ");
  }

  nearest(at) {
    const far = s => Math.abs(s.x[0] - at), s = this.shown.reduce((a, b) => far(b) < far(a) ? b : a, this.shown[0]);
    return s ? `${s.name}: ${short(s.y[0])} ×   ${short(this.options.logX ? 10 ** s.x[0] : s.x[0])} ${this.options.xUnit}` : "\u00a0";
  }
}

// Round numbers between a and b: the widest step that still gives three, near `count` of them if there is room.
function ticks(a, b, count) {
  const rough = (b - a) / Math.max(2, count), power = 10 ** Math.floor(Math.log10(rough));
  const inside = step => Math.floor(b / step + 1e-9) - Math.ceil(a / step - 1e-9) + 1;
  const steps = [10, 5, 2, 1, 0.5].map(m => m * power);
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough && inside(s) > 2) || steps.find(s => inside(s) > 2) || power;
  const digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9))), found = [];
  for (let k = Math.ceil(a / step - 1e-9); k * step <= b + step * 1e-9; k++) {
    const v = k * step; found.push([v, Math.abs(v) >= 1e5 ? v.toExponential(1) : v.toFixed(digits)]);
  }
  return found;
}

// The same on a logarithmic axis: decades, 1-2-5 where there are few, round numbers in less than half a decade.
function decades(a, b, count) {
  const every = Math.max(1, Math.ceil((b - a) / Math.max(2, count))), few = b - a < 2.5;
  const found = [], word = (m, k) => k >= -3 && k < 4 ? String(+(m * 10 ** k).toPrecision(3)) : m + "e" + k;
  for (let k = Math.floor(a); k <= b; k++)
    for (const m of few ? [1, 2, 5] : [1]) {
      const at = k + Math.log10(m);
      if (k % every === 0 && at >= a && at <= b) found.push([at, word(m, k)]);
    }
  if (found.length < 2) return ticks(10 ** a, 10 ** b, count).filter(([v]) => v > 0).map(([v, text]) => [Math.log10(v), text]);
  return found;
}
