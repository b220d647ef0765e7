// The page: unpacks the data of a channel when it is chosen, makes the plots.
"use strict";

async function timeOf(page) {
  if (page.time.packed) return unpack(page.time.packed);
  const found = new Float64Array(page.count);
  for (let i = 0; i < found.length; i++) found[i] = page.time.start + i * page.time.step;
  return found;
}

// A channel as it is drawn. A long record of many channels would fill a phone if all were unpacked at once.
async function channelOf(packed, time) {
  const raw = await unpack(packed.raw), clean = await unpack(packed.clean), difference = new Float32Array(raw.length);
  for (let i = 0; i < raw.length; i++) difference[i] = clean[i] - raw[i];
  let view = null;
  if (packed.view) {
    const models = [];
    for (const m of packed.view.models) models.push({ name: m.name, probability: await unpack(m.probability) });
    const [first, every] = packed.view.index;
    const at = Float64Array.from(models[0].probability, (_, i) => time[first + i * every]);
    view = { models, at, frequency: await unpack(packed.view.frequency) };
  }
  return { ...packed, raw, clean, difference, view };
}

async function start() {
  const page = JSON.parse(document.getElementById("data").textContent), $ = id => document.getElementById(id);
  const time = await timeOf(page), channels = page.channels.map(() => null);
  const over = new Group(), bands = new Group(), taus = new Group();
  let now = page.channels[0], wanted = -1;
  over.full = [time[0], time[time.length - 1]];
  over.least = 4 * (over.full[1] - over.full[0]) / Math.max(4, time.length);
  const marks = () => now.flags.map(f => ({ colour: "--flag", x: f.at.map(i => time[i]) }));
  const timePlot = (id, options) => new Plot($(id), over, { xUnit: "s", ...options });
  const plots = {
    rate: timePlot("rate", { title: `Rate, ${page.unit}`, height: 300, marks, count: true }),
    difference: timePlot("difference", { title: `Taken away: clean − raw, ${page.unit}`, height: 150, count: true }),
    probability: timePlot("probability", { title: "Model probabilities", height: 170, fixed: [-0.03, 1.03] }),
    frequency: timePlot("frequency", { title: "Manoeuvre frequency, Hz", height: 140 }),
    spectrum: new Plot($("spectrum"), bands, { title: `Spectral density, (${page.unit})²/Hz`, logX: true, logY: true, xUnit: "Hz", height: 260 }),
    allan: new Plot($("allan"), taus, { title: `Allan deviation, ${page.unit}`, logX: true, logY: true, xUnit: "s", height: 260 }),
  };
  const log10 = values => Float64Array.from(values, Math.log10);
  const pair = (group, plot, curves) => {
    $(plot).hidden = !curves;
    if (!curves) return;
    const x = log10(curves.x);
    group.full = [x[0], x[x.length - 1]]; group.range = group.range || group.full.slice();
    // A broad line beneath: where both agree, it is still seen.
    plots[plot].set([{ name: "raw", colour: "--raw", x, y: curves.raw, wide: 4 }, { name: "clean", colour: "--clean", x, y: curves.clean, wide: 1.5 }]);
  };
  const choose = async index => {
    wanted = index;
    document.querySelectorAll("#tabs button").forEach((b, i) => b.setAttribute("aria-pressed", String(i === index)));
    const chosen = channels[index] || (channels[index] = await channelOf(page.channels[index], time));
    if (wanted !== index) return;
    now = chosen;
    plots.rate.set([{ name: "raw", colour: "--raw", x: time, y: now.raw, wide: 2 }, { name: "clean", colour: "--clean", x: time, y: now.clean, wide: 1.5 }]);
    if (!document.body.dataset.ready) requestAnimationFrame(() => performance.mark("first figure"));
    plots.difference.set([{ name: "clean − raw", colour: "--raw", x: time, y: now.difference }]);
    const view = now.view, at = view && view.at;
    $("probability").hidden = !(view && view.models.length > 1);
    if (view && view.models.length > 1)
      plots.probability.set(view.models.map((m, k) => ({ name: m.name, colour: `--m${k % 10}`, x: at, y: m.probability })));
    const moving = view && view.frequency;
    $("frequency").hidden = !moving;
    if (moving) plots.frequency.set([{ name: "frequency", colour: "--clean", x: at, y: view.frequency }]);
    pair(bands, "spectrum", now.spectrum); pair(taus, "allan", now.allan);
    $("flags").textContent = now.flags.length ? "Marks at the foot of the plot: " + now.flags.map(f => `${f.count} ${f.name}`).join(", ") : "";
    $("settings").textContent = now.settings;
  };
  over.range = over.full.slice();
  $("tabs").hidden = channels.length < 2;
  page.channels.forEach((c, i) => {
    const b = document.createElement("button"); b.textContent = c.name; b.onclick = () => choose(i).catch(failed); $("tabs").append(b);
  });
  for (const [id, act] of [["in", () => over.zoom(0.4)], ["out", () => over.zoom(2.5)], ["left", () => over.pan(-0.4)],
    ["right", () => over.pan(0.4)], ["all", () => { over.reset(); bands.range && bands.reset(); taus.range && taus.reset(); }]]) $(id).onclick = act;
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => choose(wanted).catch(failed));
  await choose(0);
  window.stillrate = { over, bands, taus, plots, channels };
  document.body.dataset.ready = "1";
}

start().catch(failed);
