// The page of a comparison: gain against price, the table behind it, and what each method made of two stretches.
"use strict";

const PRICES = {
  distortion: { title: "distortion, in units of the noise", unit: "σ", log: true, of: row => row.distortion },
  lag: { title: "how late, ms", unit: "ms", log: false, of: row => row.lag === null ? null : Math.abs(row.lag) },
  settling: { title: "settling, s", unit: "s", log: false, of: row => row.settling },
  cost: { title: "cost, ns a sample", unit: "ns", log: true, of: row => row.cost },
};
const COLUMNS = [["method", "method"], ["rest", "rest ×"], ["lag", "lag ms"], ["distortion", "distortion σ"], ["settling", "settling s"], ["cost", "cost ns"]];
// Lines that are drawn at first: these, or the first three where fewer than two of them were compared.
const FAMILIAR = ["ms-imm-ikf", "one-euro", "pt1"];

const colourOf = k => `--m${k % 12}`, dashOf = k => k < 12 ? [] : [5, 3];
const fixed = (value, digits) => value === null ? "–" : value === "inf" ? "never" : value.toFixed(digits);

const signed = v => { const text = v.toFixed(2); return Number(text) > 0 ? "+" + text : text.replace(/^-(0\.0+)$/, "$1"); };

function cells(row, reach) {
  const far = row.lag !== null && Math.abs(row.lag) >= reach;
  const lag = row.lag === null ? "–" : far ? `> ${(Math.sign(row.lag) * reach).toFixed(0)}` : signed(row.lag);
  return [row.rest === null ? "–" : row.rest === "inf" ? "∞" : String(+row.rest.toPrecision(3)), lag, fixed(row.distortion, 2), fixed(row.settling, 3), row.cost.toFixed(0)];
}

// Ascending; what is missing or never comes last.
function order(rows, key, down) {
  const rank = row => {
    const v = key === "lag" && row.lag !== null ? Math.abs(row.lag) : row[key];
    return v === null || v === "inf" ? Infinity : v;
  };
  const one = (a, b) => typeof a[key] === "string" && key === "method" ? a.method.localeCompare(b.method) : rank(a) - rank(b) || 0;
  return [...rows].sort((a, b) => rank(a) === Infinity && key !== "method" ? 1 : rank(b) === Infinity && key !== "method" ? -1 : down ? one(b, a) : one(a, b));
}

async function linesOf(stretch) {
  const time = await unpack(stretch.time), clean = {};
  for (const [method, packed] of Object.entries(stretch.clean)) clean[method] = await unpack(packed);
  return { time, raw: await unpack(stretch.raw), clean };
}

async function start() {
  const page = JSON.parse(document.getElementById("data").textContent), $ = id => document.getElementById(id);
  const took = row => row.distortion !== null && row.distortion > page.took_motion;
  const points = new Group(), still = new Group(), moving = new Group(), unpacked = page.channels.map(() => null);
  const gain = new Plot($("gain"), points, { title: "", height: 330, logY: true, logX: true, xUnit: "σ", points: true });
  const plots = {
    gain,
    rest: new Plot($("rest"), still, { title: `At rest, ${page.unit}`, height: 220, xUnit: "s" }),
    motion: new Plot($("motion"), moving, { title: `Where it moves most, ${page.unit}`, height: 300, xUnit: "s" }),
  };
  const numbers = new Map(page.methods.map((name, k) => [name, k]));
  const familiar = page.methods.filter(name => FAMILIAR.includes(name)), first = familiar.length > 1 ? familiar : page.methods.slice(0, 3);
  const hidden = new Set(page.methods.filter(name => !first.includes(name)));
  let now = page.channels[0], wanted = 0, price = "distortion", sort = ["method", false], sorted = false;
  plots.rest.hidden = plots.motion.hidden = hidden;

  const scatter = () => {
    const kind = PRICES[price], place = v => kind.log ? Math.log10(v) : v, outside = [];
    const series = [];
    for (const row of now.rows) {
      const x = kind.of(row);
      if (typeof row.rest !== "number" || typeof x !== "number" || (kind.log && !(x > 0))) { outside.push(row.method); continue; }
      series.push({ name: row.method, colour: took(row) ? "--raw" : "--clean", x: [place(x)], y: [row.rest], dots: true, label: true });
    }
    const all = series.map(s => s.x[0]), low = Math.min(...all), high = Math.max(...all), edge = 0.08 * (high - low) || 0.5;
    gain.options.logX = kind.log; gain.options.xUnit = kind.unit;
    gain.title.textContent = `Gain at rest, raw over filtered, against its price: ${kind.title}`;
    gain.canvas.setAttribute("aria-label", gain.title.textContent);
    points.full = series.length ? [low - edge, high + 2.5 * edge] : [0, 1]; points.range = points.full.slice();
    gain.set(series);
    $("gain").hidden = $("prices").hidden = !series.length;
    $("outside").textContent = series.length ? (outside.length ? `Not in this figure, for want of a number: ${outside.join(", ")}.` : "")
      : "This log never rests: there is no gain to show. Lag, distortion, settling and cost stand in the table.";
    document.querySelectorAll("#prices button").forEach(b => b.setAttribute("aria-pressed", String(b.dataset.price === price)));
  };

  const figures = () => {
    const head = document.createElement("tr"), rows = sorted ? order(now.rows, ...sort) : now.rows;
    for (const [key, title] of COLUMNS) {
      const th = document.createElement("th"), b = document.createElement("button");
      b.textContent = title + (sorted && sort[0] === key ? (sort[1] ? " ▾" : " ▴") : "");
      // A first press puts the best on top: the largest gain, the smallest price.
      b.onclick = () => { sort = [key, sorted && sort[0] === key ? !sort[1] : key === "rest"]; sorted = true; figures(); };
      if (sorted && sort[0] === key) th.setAttribute("aria-sort", sort[1] ? "descending" : "ascending");
      th.append(b); head.append(th);
    }
    const body = rows.map(row => {
      const tr = document.createElement("tr"), first = document.createElement("td"), b = document.createElement("button");
      const k = numbers.get(row.method);
      tr.dataset.method = row.method;
      b.textContent = row.method; b.style.setProperty("--c", css(colourOf(k))); b.setAttribute("aria-pressed", String(!hidden.has(row.method)));
      b.classList.toggle("dashed", dashOf(k).length > 0);
      b.onclick = () => { hidden.has(row.method) ? hidden.delete(row.method) : hidden.add(row.method); figures(); lines(); };
      first.append(b); tr.append(first);
      if (took(row)) tr.className = "took";
      cells(row, page.reach_ms).forEach(text => { const td = document.createElement("td"); td.textContent = text; tr.append(td); });
      return tr;
    });
    const top = document.createElement("thead"), rest = document.createElement("tbody");
    top.append(head); rest.append(...body); $("figures").replaceChildren(top, rest);
  };

  const lines = () => {
    const found = unpacked[wanted];
    for (const [name, group] of [["rest", still], ["motion", moving]]) {
      const stretch = found && found[name];
      $(name).hidden = !stretch;
      if (!stretch) continue;
      const last = stretch.time.length - 1, full = [stretch.time[0], stretch.time[last]];
      if (!group.full || group.full[0] !== full[0] || group.full[1] !== full[1]) { group.full = full; group.range = full.slice(); }
      group.least = 4 * (full[1] - full[0]) / Math.max(4, last);
      plots[name].set([{ name: "raw", colour: "--grey", x: stretch.time, y: stretch.raw, wide: 1 }, ...page.methods.map((method, k) => ({
        name: method, colour: colourOf(k), dash: dashOf(k), x: stretch.time, y: stretch.clean[method], wide: 1.6 }))]);
    }
  };
  for (const plot of [plots.rest, plots.motion]) plot.toggled = () => { figures(); lines(); };

  const choose = async index => {
    wanted = index; now = page.channels[index];
    document.querySelectorAll("#tabs button").forEach((b, i) => b.setAttribute("aria-pressed", String(i === index)));
    $("about").textContent = now.about;
    scatter(); figures();
    if (!document.body.dataset.ready) requestAnimationFrame(() => performance.mark("first figure"));
    if (!unpacked[index]) {
      const found = {};
      for (const [name, stretch] of Object.entries(now.stretches)) found[name] = await linesOf(stretch);
      unpacked[index] = found;
    }
    if (wanted === index) lines();
  };
  for (const name of Object.keys(PRICES)) {
    const b = document.createElement("button");
    b.textContent = name; b.dataset.price = name; b.onclick = () => { price = name; scatter(); }; $("prices").append(b);
  }
  $("tabs").hidden = page.channels.length < 2;
  page.channels.forEach((c, i) => {
    const b = document.createElement("button"); b.textContent = c.name; b.onclick = () => choose(i).catch(failed); $("tabs").append(b);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => choose(wanted).catch(failed));
  await choose(0);
  window.stillrate = { plots, points, still, moving, hidden };
  document.body.dataset.ready = "1";
}

start().catch(failed);
