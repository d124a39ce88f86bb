// Draws every <figure class="chart"> from its JSON. Drag: zoom along x; double click: all; hover: values.
(() => {
  const groups = {};
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const three = (v) => {
    if (v === null || v === undefined || !isFinite(v)) return "–";
    const a = Math.abs(v);
    return (a !== 0 && (a < 1e-4 || a >= 1e6) ? v.toExponential(2) : String(+v.toPrecision(4))).replace("-", "−");
  };
  const ticks = (low, high, count) => {
    const raw = (high - low) / Math.max(1, count), ten = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= raw) || raw;
    const found = [];
    for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return found;
  };
  const range = (values) => {
    let low = Infinity, high = -Infinity;
    for (const v of values) if (v !== null) { if (v < low) low = v; if (v > high) high = v; }
    if (low > high) return [0, 1];
    return low === high ? [low - 1, high + 1] : [low, high];
  };
  const nearest = (x, at) => {
    let a = 0, b = x.length - 1;
    while (b - a > 1) { const m = (a + b) >> 1; if (x[m] <= at) a = m; else b = m; }
    return Math.abs(x[a] - at) <= Math.abs(x[b] - at) ? a : b;
  };
  class Chart {
    constructor(figure) {
      this.spec = JSON.parse(figure.querySelector("script").textContent);
      this.canvas = figure.querySelector("canvas");
      this.legend = figure.querySelector(".legend");
      this.all = range(this.spec.series.flatMap((s) => range(s.x)));
      this.view = this.all;
      this.ordered = this.spec.series.filter((s) => s.kind === "line" && s.x.every((v, i) => !i || v === null || v >= s.x[i - 1]));
      (groups[this.spec.group || Symbol()] ||= []).push(this);
      this.mates = this.spec.group ? groups[this.spec.group] : [this];
      this.say(null);
      const x = (e) => {
        const box = this.canvas.getBoundingClientRect(), p = this.pad;
        const part = (e.clientX - box.left - p.l) / (box.width - p.l - p.r);
        return this.view[0] + Math.min(1, Math.max(0, part)) * (this.view[1] - this.view[0]);
      };
      this.canvas.addEventListener("pointerdown", (e) => {
        if (e.pointerType === "touch") this.mates.forEach((c) => c.hover(x(e)));  // a tap shows values until the next one
        else this.from = x(e);
      });
      this.canvas.addEventListener("pointermove", (e) => { const at = x(e); this.mates.forEach((c) => c.hover(at, c === this ? this.from : undefined)); });
      this.canvas.addEventListener("pointerleave", (e) => { if (e.pointerType !== "touch") this.mates.forEach((c) => c.hover(null)); });
      window.addEventListener("pointerup", (e) => {
        if (this.from === undefined) return;
        const to = x(e), view = [Math.min(this.from, to), Math.max(this.from, to)];
        this.from = undefined;
        if (view[1] - view[0] > 0.01 * (this.view[1] - this.view[0])) this.mates.forEach((c) => { c.view = view; c.draw(); });
        else this.draw();
      });
      this.canvas.addEventListener("dblclick", () => this.mates.forEach((c) => { c.view = c.all; c.draw(); }));
      new ResizeObserver(() => this.draw()).observe(this.canvas);
    }
    hover(at, from) { this.draw(at, from); this.say(at); }
    say(at) {
      const add = (to, tag, text, kind) => { const e = document.createElement(tag); e.textContent = text; if (kind) e.className = kind; to.append(e); return e; };
      this.legend.replaceChildren();
      for (const s of this.spec.series) {
        const item = add(this.legend, "span", "");
        add(item, "i", "", s.kind).style.background = `var(--${s.colour})`;
        item.append(s.name + " ");
        if (at !== null && this.ordered.includes(s)) add(item, "b", three(s.y[nearest(s.x, at)]));
      }
      if (at !== null && this.ordered.length) add(this.legend, "span", `at ${three(at)}`);
    }
    draw(at = null, from) {
      const box = this.canvas.getBoundingClientRect(), dpr = window.devicePixelRatio || 1;
      if (!box.width) return;
      if (this.canvas.width !== Math.round(box.width * dpr)) { this.canvas.width = Math.round(box.width * dpr); this.canvas.height = Math.round(box.height * dpr); }
      const c = this.canvas.getContext("2d"), w = box.width, h = box.height;
      c.setTransform(dpr, 0, 0, dpr, 0, 0); c.clearRect(0, 0, w, h);
      c.font = "12px system-ui, sans-serif";
      const [x0, x1] = this.view, inside = [];
      for (const s of this.spec.series) for (let i = 0; i < s.x.length; i++) if (s.x[i] !== null && s.x[i] >= x0 && s.x[i] <= x1) inside.push(s.y[i]);
      let [y0, y1] = range(inside); const air = 0.06 * (y1 - y0); y0 -= air; y1 += air;
      const yt = ticks(y0, y1, h / 45), labels = yt.map(three);
      const p = this.pad = { l: 26 + Math.max(...labels.map((t) => c.measureText(t).width), 10), r: 10, t: 6, b: 36 };
      const X = (v) => p.l + ((v - x0) / (x1 - x0)) * (w - p.l - p.r), Y = (v) => h - p.b - ((v - y0) / (y1 - y0)) * (h - p.t - p.b);
      c.strokeStyle = css("--line"); c.fillStyle = css("--soft"); c.lineWidth = 1; c.textBaseline = "middle";
      yt.forEach((v, i) => { c.beginPath(); c.moveTo(p.l, Y(v)); c.lineTo(w - p.r, Y(v)); c.stroke(); c.textAlign = "right"; c.fillText(labels[i], p.l - 5, Y(v)); });
      c.textAlign = "center"; c.textBaseline = "top";
      for (const v of ticks(x0, x1, (w - p.l) / 80)) { c.beginPath(); c.moveTo(X(v), p.t); c.lineTo(X(v), h - p.b); c.stroke(); c.fillText(three(v), X(v), h - p.b + 4); }
      c.fillText(this.spec.x_label, (p.l + w - p.r) / 2, h - 14);
      c.save(); c.translate(11, (h - p.b + p.t) / 2); c.rotate(-Math.PI / 2); c.textBaseline = "middle"; c.fillText(this.spec.y_label, 0, 0); c.restore();
      c.save(); c.beginPath(); c.rect(p.l, p.t, w - p.l - p.r, h - p.t - p.b); c.clip();
      for (const s of this.spec.series) {
        c.strokeStyle = c.fillStyle = css("--" + s.colour);
        if (s.kind === "points") {
          c.globalAlpha = s.colour === "measured" ? 0.55 : 0.3;
          for (let i = 0; i < s.x.length; i++) if (s.y[i] !== null) c.fillRect(X(s.x[i]) - 1, Y(s.y[i]) - 1, 2, 2);
          c.globalAlpha = 1;
        } else {
          c.lineWidth = s.colour === "measured" ? 2.4 : 1.3; c.setLineDash(/target|law[1357]/.test(s.colour) ? [3, 3] : []);
          c.beginPath(); let pen = false;
          for (let i = 0; i < s.x.length; i++) {
            if (s.y[i] === null || s.x[i] === null) { pen = false; continue; }
            if (pen) c.lineTo(X(s.x[i]), Y(s.y[i])); else c.moveTo(X(s.x[i]), Y(s.y[i]));
            pen = true;
          }
          c.stroke(); c.setLineDash([]);
        }
      }
      if (from !== undefined && at !== null) { c.globalAlpha = 0.15; c.fillStyle = css("--ink"); c.fillRect(X(Math.min(from, at)), p.t, Math.abs(X(at) - X(from)), h); c.globalAlpha = 1; }
      if (at !== null) { c.strokeStyle = css("--soft"); c.lineWidth = 1; c.beginPath(); c.moveTo(X(at), p.t); c.lineTo(X(at), h - p.b); c.stroke(); }
      c.restore();
    }
  }
  const charts = [...document.querySelectorAll("figure.chart")].map((f) => new Chart(f));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach((c) => c.draw()));
})();
