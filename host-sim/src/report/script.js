// What a page of a report does where scripts run: values under the pointer, zoom, and a cue where something
// scrolls sideways. Without it the page shows the same figures.
(function () {
  "use strict";

  // What a chart's attributes say of an axis: "low high log", in the unit of its name.
  function axis(svg, letter) {
    var ends = svg.dataset[letter].split(" ").map(Number);
    var parts = /^(.*?)(?: \[(.*)\])?$/.exec(svg.dataset[letter + "n"]);
    return { low: ends[0], high: ends[1], log: ends[2] === 1, name: parts[1], unit: parts[2] || "" };
  }

  function Chart(svg) {
    var box = svg.viewBox.baseVal;
    var plot = svg.querySelector("svg.plot");
    this.svg = svg;
    this.width = box.width;
    this.plots = Array.prototype.slice.call(svg.querySelectorAll("svg.plot, svg.back"));
    this.left = plot.x.baseVal.value;
    this.top = plot.y.baseVal.value;
    this.w = plot.width.baseVal.value;
    this.h = plot.height.baseVal.value;
    this.x = axis(svg, "x");
    this.y = axis(svg, "y");
    this.view = [0, 1, 0, 1]; // left, right, bottom, top, as shares of the whole plot
    this.figure = svg.closest("figure");
    this.mark = null;
  }

  // The value at a share of an axis.
  function value(axis, share) {
    var at = axis.low + share * (axis.high - axis.low);
    return axis.log ? Math.pow(10, at) : at;
  }

  function digits(number, step) {
    if (!isFinite(number)) { return "–"; }
    var size = Math.abs(number);
    if (size !== 0 && (size < 1e-4 || size >= 1e6)) { return number.toPrecision(4).replace("-", "−"); }
    var places = Math.min(8, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
    return number.toFixed(places).replace("-", "−");
  }

  // A number as precisely as a tenth of a pixel tells it.
  function shown(axis, share, pixels) {
    var number = value(axis, share);
    var next = value(axis, share + 1 / pixels);
    return digits(number, Math.abs(next - number)) + (axis.unit ? " " + axis.unit : "");
  }

  // The curves of a chart, read off its paths: points in units of the drawing.
  Chart.prototype.curves = function () {
    if (this.read) { return this.read; }
    var chart = this;
    this.read = Array.prototype.map.call(this.svg.querySelectorAll("svg.plot path[data-s]"), function (path) {
      var numbers = path.getAttribute("d").replace(/h0/g, "").match(/-?\d+/g).map(Number);
      var xs = [], ys = [], x = 0, y = 0, sorted = true;
      for (var i = 0; i + 1 < numbers.length; i += 2) {
        x += numbers[i];
        y += numbers[i + 1];
        sorted = sorted && (i === 0 || numbers[i] >= 0);
        xs.push(x);
        ys.push(y);
      }
      var kind = path.classList.contains("band") ? "band"
        : path.classList.contains("envelope") ? "envelope" : "line";
      return {
        kind: kind, series: path.dataset.s, name: chart.svg.dataset["n" + path.dataset.s] || chart.y.name,
        xs: xs, ys: ys, sorted: sorted && kind === "line",
      };
    });
    return this.read;
  };

  // The point of a curve that is nearest to a place: in x for a curve over time, else in both.
  function nearest(curve, x, y) {
    var best = -1, least = Infinity, from = 0, to = curve.xs.length;
    if (curve.sorted) {
      var low = 0, high = to;
      while (low < high) {
        var middle = (low + high) >> 1;
        if (curve.xs[middle] < x) { low = middle + 1; } else { high = middle; }
      }
      from = Math.max(0, low - 4);
      to = Math.min(to, low + 4);
    }
    for (var i = from; i < to; i++) {
      var dx = curve.xs[i] - x, dy = curve.ys[i] - y;
      var far = curve.sorted ? Math.abs(dx) + 1e-4 * Math.abs(dy) : dx * dx + dy * dy;
      if (far < least) { least = far; best = i; }
    }
    return best;
  }

  // The lowest and the highest point of an outline near x.
  function extent(curve, x, reach) {
    var low = Infinity, high = -Infinity;
    for (var i = 0; i < curve.xs.length; i++) {
      if (Math.abs(curve.xs[i] - x) <= reach) {
        low = Math.min(low, curve.ys[i]);
        high = Math.max(high, curve.ys[i]);
      }
    }
    return low <= high ? [low, high] : null;
  }

  // A place of the pointer in units of the drawing, and there in those of the whole plot.
  Chart.prototype.place = function (event) {
    var frame = this.svg.getBoundingClientRect();
    var scale = this.width / frame.width;
    var x = (event.clientX - frame.left) * scale, y = (event.clientY - frame.top) * scale;
    var sx = (x - this.left) / this.w, sy = 1 - (y - this.top) / this.h;
    var v = this.view;
    return {
      x: x, y: y, sx: sx, sy: sy, inside: sx >= 0 && sx <= 1 && sy >= 0 && sy <= 1,
      fx: v[0] + sx * (v[1] - v[0]), fy: v[2] + sy * (v[3] - v[2]),
    };
  };

  Chart.prototype.rows = function (at) {
    var chart = this, v = this.view;
    var px = this.left + at.fx * this.w, py = this.top + (1 - at.fy) * this.h;
    var share = function (y) { return 1 - (y - chart.top) / chart.h; };
    var found = {};
    var list = [];
    var pixels = this.h / (v[3] - v[2]);
    this.curves().forEach(function (curve) {
      var row = found[curve.series];
      if (!row) { row = found[curve.series] = { name: curve.name, least: Infinity }; list.push(row); }
      if (curve.kind === "line") {
        var i = nearest(curve, px, py);
        if (i < 0) { return; }
        var far = Math.abs(curve.xs[i] - px) + (curve.sorted ? 0 : Math.abs(curve.ys[i] - py));
        // Where a curve has a gap it has no value.
        if (far < row.least && (!curve.sorted || far < 0.01 * chart.w + 20)) {
          row.least = far;
          row.x = (curve.xs[i] - chart.left) / chart.w;
          row.y = share(curve.ys[i]);
          row.sorted = curve.sorted;
        }
      } else {
        var ends = extent(curve, px, 12);
        if (ends) { row[curve.kind] = [share(ends[1]), share(ends[0])]; }
      }
    });
    return list.filter(function (row) {
      return row.y !== undefined || row.envelope || row.band;
    }).map(function (row) {
      var text;
      if (row.envelope) {
        text = shown(chart.y, row.envelope[0], pixels) + " … " + shown(chart.y, row.envelope[1], pixels);
      } else if (row.y !== undefined) {
        text = shown(chart.y, row.y, pixels);
        if (!row.sorted) { text += " at " + shown(chart.x, row.x, chart.w / (v[1] - v[0])); }
      } else {
        text = "±";
      }
      if (row.band) {
        var half = Math.abs(value(chart.y, row.band[1]) - value(chart.y, row.band[0])) / 2;
        var step = Math.abs(value(chart.y, 1 / pixels) - value(chart.y, 0));
        text = (text === "±" ? "" : text + " ") + "± " + digits(half, step);
      }
      return [row.name, text];
    });
  };

  var tip = null;

  function hide() { if (tip) { tip.hidden = true; } }

  Chart.prototype.show = function (event) {
    var at = this.place(event);
    this.cross(at.inside ? at : null);
    if (!at.inside) { hide(); return; }
    if (!tip) {
      tip = document.createElement("div");
      tip.className = "tip";
      tip.setAttribute("role", "status");
      document.body.appendChild(tip);
    }
    tip.textContent = "";
    var head = document.createElement("b");
    head.textContent = this.x.name + " " + shown(this.x, at.fx, this.w / (this.view[1] - this.view[0]));
    tip.appendChild(head);
    this.rows(at).forEach(function (row) {
      var line = document.createElement("div");
      line.textContent = row[0] + ": " + row[1];
      tip.appendChild(line);
    });
    tip.hidden = false;
    var room = document.documentElement.clientWidth;
    var x = event.clientX + 14, y = event.clientY + 14;
    if (x + tip.offsetWidth > room - 4) { x = Math.max(4, event.clientX - tip.offsetWidth - 10); }
    if (y + tip.offsetHeight > window.innerHeight - 4) { y = Math.max(4, event.clientY - tip.offsetHeight - 10); }
    tip.style.left = x + "px";
    tip.style.top = y + "px";
  };

  function element(name, attributes) {
    var made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (var key in attributes) { made.setAttribute(key, attributes[key]); }
    return made;
  }

  // The line under the pointer.
  Chart.prototype.cross = function (at) {
    if (!this.line) {
      this.line = element("path", { "class": "cross" });
      this.svg.appendChild(this.line);
    }
    this.line.setAttribute("d", at ? "M" + at.x + " " + this.top + "v" + this.h : "");
  };

  // Round numbers between two values, at most `most` of them.
  function ticks(low, high, most, log) {
    var out = [];
    if (log && high - low > 1.2) {
      for (var e = Math.ceil(low - 1e-9); e <= high + 1e-9; e++) { out.push([e, Math.pow(10, e).toPrecision(1)]); }
      return out.map(function (tick) { return [tick[0], String(Number(tick[1]))]; });
    }
    var a = log ? Math.pow(10, low) : low, b = log ? Math.pow(10, high) : high;
    var rough = (b - a) / most, decade = Math.pow(10, Math.floor(Math.log10(rough)));
    var step = [1, 2, 5, 10].map(function (m) { return m * decade; })
      .filter(function (s) { return s >= rough * (1 - 1e-9); })[0];
    for (var i = Math.ceil(a / step - 1e-6); i <= b / step + 1e-6 && out.length < 40; i++) {
      out.push([log ? Math.log10(i * step) : i * step, digits(i * step, step)]);
    }
    return out;
  }

  // Draws the grid and its numbers for what is in view; the drawing's own stand for the whole.
  Chart.prototype.grid = function () {
    if (this.own) { this.own.remove(); this.own = null; }
    var v = this.view, chart = this;
    var whole = v[0] === 0 && v[1] === 1 && v[2] === 0 && v[3] === 1;
    this.svg.classList.toggle("zoomed", !whole);
    if (whole) { return; }
    var group = element("g", { "class": "own" });
    var ends = function (axis, from, to) {
      var size = axis.high - axis.low;
      return [axis.low + from * size, axis.low + to * size];
    };
    var text = function (attributes, label) {
      var made = element("text", attributes);
      made.textContent = label;
      group.appendChild(made);
    };
    var bottom = this.top + this.h;
    var x = ends(this.x, v[0], v[1]), y = ends(this.y, v[2], v[3]);
    ticks(x[0], x[1], Math.max(2, Math.floor(this.w / 800)), this.x.log).forEach(function (tick) {
      var at = chart.left + (tick[0] - x[0]) / (x[1] - x[0]) * chart.w;
      group.appendChild(element("path", { "class": "grid", d: "M" + at + " " + chart.top + "V" + bottom }));
      text({ "class": "tick", x: at, y: bottom + 60, dy: "0.76em", "text-anchor": "middle" }, tick[1]);
    });
    ticks(y[0], y[1], Math.max(2, Math.floor(this.h / 360)), this.y.log).forEach(function (tick) {
      var at = bottom - (tick[0] - y[0]) / (y[1] - y[0]) * chart.h;
      group.appendChild(element("path", { "class": "grid", d: "M" + chart.left + " " + at + "h" + chart.w }));
      text({ "class": "tick", x: chart.left - 60, y: at, dy: "0.36em", "text-anchor": "end" }, tick[1]);
    });
    group.appendChild(element("path", {
      "class": "axis", d: "M" + this.left + " " + this.top + "v" + this.h + "h" + this.w,
    }));
    this.svg.insertBefore(group, this.plots[this.plots.length - 1]);
    this.own = group;
  };

  // Moves what stands above the plot: states and the names of events.
  Chart.prototype.above = function () {
    var v = this.view, left = this.left, w = this.w, right = left + w;
    var move = function (x) { return left + ((x - left) / w - v[0]) / (v[1] - v[0]) * w; };
    if (!this.strips) {
      this.strips = Array.prototype.map.call(this.svg.querySelectorAll("rect.strip"), function (rect) {
        var x = rect.x.baseVal.value;
        return { rect: rect, from: x, to: x + rect.width.baseVal.value };
      });
      this.labels = Array.prototype.map.call(this.svg.querySelectorAll(".strip-label, .event-label"), function (text) {
        return { text: text, x: Number(text.getAttribute("x")), line: text.dataset.x };
      });
    }
    var strips = this.strips;
    var clip = function (x) { return Math.min(right, Math.max(left, x)); };
    strips.forEach(function (strip) {
      var from = clip(move(strip.from)), to = clip(move(strip.to));
      strip.rect.setAttribute("x", from);
      strip.rect.setAttribute("width", Math.max(0, to - from));
    });
    var whole = v[0] === 0 && v[1] === 1;
    this.labels.forEach(function (label) {
      var at = label.x, seen = true;
      if (!whole && label.line !== undefined) {
        at = move(Number(label.line));
        seen = at >= left && at <= right;
      } else if (!whole) {
        var own = strips.filter(function (strip) { return strip.from <= label.x && label.x <= strip.to; })[0];
        var from = own ? clip(move(own.from)) : 0, to = own ? clip(move(own.to)) : 0;
        at = (from + to) / 2;
        seen = to - from > 60 * label.text.textContent.length;
      }
      label.text.setAttribute("x", at);
      label.text.style.visibility = seen ? "" : "hidden";
    });
  };

  Chart.prototype.draw = function () {
    var v = this.view;
    var box = [
      this.left + v[0] * this.w, this.top + (1 - v[3]) * this.h, (v[1] - v[0]) * this.w, (v[3] - v[2]) * this.h,
    ];
    this.plots.forEach(function (plot) { plot.setAttribute("viewBox", box.join(" ")); });
    this.grid();
    this.above();
  };

  // Shows a part of the plot, and the same stretch in all figures over the same time.
  Chart.prototype.zoom = function (x0, x1, y0, y1) {
    var span = Math.max(1e-4, Math.min(1, x1 - x0));
    x0 = Math.max(0, Math.min(1 - span, x0));
    var tall = Math.max(1e-3, Math.min(1, y1 - y0));
    y0 = Math.max(0, Math.min(1 - tall, y0));
    this.view = [x0, span === 1 ? 1 : x0 + span, y0, tall === 1 ? 1 : y0 + tall];
    this.draw();
    if (this.x.name !== "Time") { return; }
    var self = this;
    charts.forEach(function (other) {
      if (other !== self && other.svg.dataset.x === self.svg.dataset.x && other.x.name === "Time") {
        other.view[0] = self.view[0];
        other.view[1] = self.view[1];
        other.draw();
      }
    });
  };

  Chart.prototype.scale = function (times) {
    var v = this.view, middle = (v[0] + v[1]) / 2, half = (v[1] - v[0]) / 2 * times;
    var y = [v[2], v[3]];
    if (this.x.name !== "Time") {
      var m = (v[2] + v[3]) / 2, h = (v[3] - v[2]) / 2 * times;
      y = [m - h, m + h];
    }
    this.zoom(middle - half, middle + half, y[0], y[1]);
  };

  Chart.prototype.reset = function () { this.zoom(0, 1, 0, 1); };

  Chart.prototype.pan = function (share) {
    var v = this.view, by = share * (v[1] - v[0]);
    this.zoom(v[0] + by, v[1] + by, v[2], v[3]);
  };

  Chart.prototype.listen = function () {
    var chart = this, start = null, frame = null, svg = this.svg;
    svg.addEventListener("pointermove", function (event) {
      chart.show(event);
      if (!start) { return; }
      var at = chart.place(event);
      var x = Math.min(start.x, at.x), w = Math.abs(at.x - start.x);
      var tall = Math.abs(at.y - start.y) > 0.12 * chart.h;
      if (!frame) { frame = element("rect", { "class": "zoom" }); svg.appendChild(frame); }
      frame.setAttribute("x", x);
      frame.setAttribute("width", w);
      frame.setAttribute("y", tall ? Math.min(start.y, at.y) : chart.top);
      frame.setAttribute("height", tall ? Math.abs(at.y - start.y) : chart.h);
    });
    svg.addEventListener("pointerdown", function (event) {
      var at = chart.place(event);
      chart.show(event);
      // A finger scrolls the page; the buttons zoom for it.
      if (event.pointerType === "touch" || event.button !== 0 || !at.inside) { return; }
      start = at;
      if (svg.setPointerCapture && event.isTrusted) { svg.setPointerCapture(event.pointerId); }
      event.preventDefault();
    });
    svg.addEventListener("pointerup", function (event) {
      if (!start) { return; }
      var at = chart.place(event), from = start;
      start = null;
      if (frame) { frame.remove(); frame = null; }
      if (Math.abs(at.x - from.x) < 60) { return; }
      var tall = Math.abs(at.y - from.y) > 0.12 * chart.h;
      var y = tall ? [Math.min(from.fy, at.fy), Math.max(from.fy, at.fy)] : [chart.view[2], chart.view[3]];
      chart.zoom(Math.min(from.fx, at.fx), Math.max(from.fx, at.fx), y[0], y[1]);
    });
    svg.addEventListener("pointercancel", function () {
      start = null;
      if (frame) { frame.remove(); frame = null; }
    });
    svg.addEventListener("pointerleave", function () { chart.cross(null); hide(); });
    svg.addEventListener("dblclick", function () { chart.reset(); });
    svg.setAttribute("tabindex", "0");
    svg.addEventListener("keydown", function (event) {
      var act = {
        "+": function () { chart.scale(0.5); }, "=": function () { chart.scale(0.5); },
        "-": function () { chart.scale(2); }, "0": function () { chart.reset(); },
        Escape: function () { chart.reset(); },
        ArrowLeft: function () { chart.pan(-0.25); }, ArrowRight: function () { chart.pan(0.25); },
      }[event.key];
      if (act && !event.ctrlKey && !event.metaKey) { act(); event.preventDefault(); }
    });
  };

  Chart.prototype.buttons = function () {
    var chart = this, head = this.figure && this.figure.querySelector(".head");
    if (!head) { return; }
    var bar = document.createElement("div");
    bar.className = "tools";
    [["+", "Zoom in", function () { chart.scale(0.5); }], ["−", "Zoom out", function () { chart.scale(2); }],
      ["whole", "Show the whole figure", function () { chart.reset(); }]].forEach(function (tool) {
      var button = document.createElement("button");
      button.type = "button";
      button.textContent = tool[0];
      button.title = tool[1];
      button.setAttribute("aria-label", tool[1]);
      button.addEventListener("click", tool[2]);
      bar.appendChild(button);
    });
    head.appendChild(bar);
  };

  // What is wider than its place fades at the edge where it goes on, and says so below.
  function cue(scroll) {
    var said = document.createElement("p");
    said.className = "cue";
    said.textContent = "↔ scroll sideways for the rest";
    scroll.insertAdjacentElement("afterend", said);
    var look = function () {
      var beyond = scroll.scrollWidth - scroll.clientWidth;
      scroll.classList.toggle("more", beyond - scroll.scrollLeft > 2);
      scroll.classList.toggle("less", beyond > 2 && scroll.scrollLeft > 2);
      said.hidden = beyond <= 2;
      if (beyond > 2) { scroll.setAttribute("tabindex", "0"); } else { scroll.removeAttribute("tabindex"); }
    };
    scroll.addEventListener("scroll", look, { passive: true });
    window.addEventListener("resize", look);
    look();
  }

  var charts = Array.prototype.map.call(document.querySelectorAll("svg.chart[data-x]"), function (svg) {
    return new Chart(svg);
  });
  charts.forEach(function (chart) { chart.listen(); chart.buttons(); });
  Array.prototype.forEach.call(document.querySelectorAll(".scroll"), cue);
  var header = document.querySelector("main > header");
  if (charts.length && header) {
    var hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent = "Point at a figure or touch it for its values. Drag over it or press + to zoom in, double-click to see it whole; " +
      "figures over the same time move together.";
    header.appendChild(hint);
  }
  window.addEventListener("scroll", hide, { passive: true });
}());
