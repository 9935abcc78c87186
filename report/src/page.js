// Turns the pictures of this page into charts to look closer at.
(() => {
  "use strict";
  const ROW = 19, WORD = 6.6, LEFT = 66, RIGHT = 14, BELOW = 46, GAP = 12, BAR = 74;
  const dark = window.matchMedia("(prefers-color-scheme: dark)");

  function library() {
    if (!window.Plotly) {
      const script = document.createElement("script");
      script.text = document.getElementById("chart-library").textContent;
      document.head.append(script);
    }
    return window.Plotly;
  }

  const number = (index) => (index === 0 ? "" : String(index + 1));
  const plain = (label) => label.replace(/&(lt|gt|amp);/g, "_");

  function colors() {
    return dark.matches
      ? { ink: "#e3e7eb", paper: "#14181c", grid: "#343c45", line: "#9aa5b1" }
      : { ink: "#222222", paper: "#ffffff", grid: "#e4e4e4", line: "#5a5a5a" };
  }

  // On a dark page black becomes white, and the dark blue lighter.
  function inked(trace, ink) {
    const copy = { ...trace }, lighter = { "#000000": ink, "#0072b2": "#3d9bd8" };
    for (const part of ["line", "marker", "error_y"]) {
      // Squares are the keys of a map, whose colours stay.
      const color = copy[part] && dark.matches && copy[part].symbol !== "square" && lighter[copy[part].color];
      if (color) copy[part] = { ...copy[part], color };
    }
    if (copy.kinds) copy.text = copy.z.map((row) => row.map((kind) => (kind === null ? "" : copy.kinds[kind])));
    if (copy.type === "heatmap") {
      const value = copy.kinds ? "%{text}" : `${copy.label || "value"}: %{z:.5~g}`;
      copy.hovertemplate = `x: %{x}<br>y: %{y}<br>${value}<extra></extra>`;
    }
    return copy;
  }

  // Labels row by row, as many in each as there is room for: the library would run over the edge.
  function flow(labels, room) {
    const rows = [];
    let used = Infinity;
    for (const label of labels) {
      const width = plain(label).length * WORD + 50;
      if (used + width > room) {
        rows.push(0);
        used = 0;
      }
      rows[rows.length - 1] += 1;
      used += width;
    }
    return rows;
  }

  // A legend for each row of labels; returns which one each label takes.
  function legends(layout, spot, share, up) {
    return spot.rows.flatMap((count, row) => {
      const id = `legend${number(spot.index * 20 + row)}`, below = (spot.rows.length - 1 - row) * ROW;
      layout[id] = {
        x: share(spot.left + spot.titled), y: up(spot.top - 2 - below), xanchor: "left", yanchor: "bottom",
        orientation: "h", bgcolor: "rgba(0,0,0,0)", font: { size: 11 },
      };
      return Array(count).fill(id);
    });
  }

  // Places of the panels in px; side by side only where there is room.
  function place(chart, width) {
    const columns = width / chart.columns < 300 ? 1 : chart.columns;
    const order = chart.panels.map((_, index) => index);
    if (columns !== chart.columns) {
      order.sort((a, b) => (a % chart.columns) - (b % chart.columns) || a - b);
    }
    const cell = width / columns, places = [];
    let top = 34;
    for (let first = 0; first < order.length; first += columns) {
      let header = 0, below = 0;
      const row = order.slice(first, first + columns).map((index, column) => {
        const panel = chart.panels[index];
        const traces = chart.traces.filter((trace) => trace.panel === index);
        const bar = traces.some((trace) => trace.type === "heatmap" && !trace.kinds) ? BAR : 0;
        const left = column * cell + LEFT, right = (column + 1) * cell - RIGHT - bar;
        const labels = traces.filter((trace) => trace.showlegend).map((trace) => trace.name);
        labels.push(...panel.lines.filter((line) => line.label).map((line) => line.label));
        // On a phone the title takes a row of its own.
        const narrow = right - left < 300 && panel.title && labels.length > 0;
        const titled = panel.title && !narrow ? plain(panel.title).length * 7.5 + 14 : 0;
        const rows = flow(labels, right - left - titled), above = narrow ? (rows.length || 1) * ROW + 3 : 0;
        const filled = Math.max(rows.length, 1) * ROW + 6 + (narrow ? ROW : 0);
        header = Math.max(header, rows.length || panel.title ? filled : 8);
        const ranges = [panel.x.range, panel.y.range].map((range) => range[1] - range[0]);
        const height = panel.toScale ? (right - left) * ranges[1] / ranges[0] : Math.max(panel.height * 1.25, 140);
        below = Math.max(below, height + (panel.open ? BELOW : GAP));
        return { index, left, right, height, titled, above, rows };
      });
      for (const spot of row) places.push({ ...spot, top: top + header, bottom: top + header + spot.height });
      top += header + below;
    }
    return { places, height: top + 6 };
  }

  function axis(of, ink) {
    const decades = of.range[1] - of.range[0];
    return {
      ...(of.type === "log" && decades >= 1.5 ? { dtick: Math.ceil(decades / 8) } : {}),
      type: of.type, range: of.range, title: { text: of.title, standoff: 6, font: { size: 12 } }, zeroline: false,
      gridcolor: ink.grid, linecolor: ink.ink, showline: true, mirror: true, ticks: "outside", ticklen: 4,
      exponentformat: "power", automargin: false, nticks: 8,
      ...(of.names?.length > 0 ? { tickmode: "array", tickvals: of.names.map(([x]) => x), ticktext: of.names.map(([, name]) => name) } : {}),
    };
  }

  function draw(chart, width) {
    const ink = colors(), { places, height } = place(chart, width);
    const within = (part) => Math.min(1, Math.max(0, part));
    const share = (px) => within(px / width), up = (px) => within(1 - px / height);
    const traces = chart.traces.map((trace) => inked(trace, ink.ink));
    const layout = {
      width, height, margin: { l: 0, r: 0, t: 0, b: 0, autoexpand: false }, paper_bgcolor: ink.paper, plot_bgcolor: ink.paper,
      font: { color: ink.ink, size: 11, family: "system-ui, sans-serif" }, hovermode: "closest", dragmode: "zoom",
      uirevision: "keep", annotations: [], shapes: [],
    };
    for (const spot of places) {
      const panel = chart.panels[spot.index], id = number(spot.index);
      const x = layout[`xaxis${id}`] = axis(panel.x, ink), y = layout[`yaxis${id}`] = axis(panel.y, ink);
      x.domain = [share(spot.left), share(spot.right)];
      y.domain = [up(spot.bottom), up(spot.top)];
      x.anchor = `y${id}`;
      y.anchor = `x${id}`;
      y.nticks = Math.max(3, Math.round(spot.height / 32));
      x.nticks = Math.max(3, Math.round((spot.right - spot.left) / 70));
      if (panel.linked !== null) x.matches = `x${number(panel.linked)}`;
      if (!panel.open) {
        x.showticklabels = false;
        x.title.text = "";
      }
      if (panel.toScale) Object.assign(y, { scaleanchor: `x${id}`, constrain: "domain" });
      const keys = legends(layout, spot, share, up);
      for (const trace of traces.filter((trace) => trace.panel === spot.index && trace.showlegend)) {
        trace.legend = keys.shift();
      }
      if (panel.title) {
        layout.annotations.push({
          text: `<b>${panel.title}</b>`, showarrow: false, xref: "paper", yref: "paper", x: share(spot.left),
          y: up(spot.top - 4 - spot.above), xanchor: "left", yanchor: "bottom",
        });
      }
      for (const line of panel.lines) {
        layout.shapes.push({
          type: "line", xref: `x${id} domain`, yref: `y${id}`, x0: 0, x1: 1, y0: line.y, y1: line.y, name: line.label,
          showlegend: line.label !== "", ...(line.label ? { legend: keys.shift() } : {}),
          line: { color: ink.line, width: 1.2, dash: "dash" },
        });
      }
      for (const trace of traces.filter((trace) => trace.panel === spot.index && trace.type === "heatmap")) {
        trace.colorbar = {
          x: share(spot.right + 8), xanchor: "left", y: up(spot.bottom), yanchor: "bottom", thickness: 11, xpad: 0,
          ypad: 0, len: spot.height / height, title: { text: trace.label, side: "right" }, outlinewidth: 0.8,
          exponentformat: "power", nticks: Math.max(3, Math.round(spot.height / 32)),
        };
      }
    }
    return { traces, layout };
  }

  const open = new Map();

  function show(figure, chart) {
    const Plotly = library(), box = figure.querySelector(".chart");
    const { traces, layout } = draw(chart, Math.floor(box.clientWidth));
    // Half a second as desktops have it: on a slow machine a large chart takes longer to answer than the library waits for.
    const options = {
        displaylogo: false,
        doubleClick: "reset",
        doubleClickDelay: 500,
        modeBarButtonsToRemove: ["lasso2d", "select2d"],
    };
    return Plotly.react(box, traces, layout, options);
  }

  function toggle(figure, button) {
    const box = figure.querySelector(".chart"), opened = !open.has(figure);
    figure.classList.toggle("closer", opened);
    box.hidden = !opened;
    button.textContent = opened ? "Back to the picture" : "Look closer";
    button.setAttribute("aria-expanded", String(opened));
    if (opened) {
      const chart = JSON.parse(figure.querySelector("script").textContent);
      open.set(figure, chart);
      show(figure, chart);
    } else {
      open.delete(figure);
      window.Plotly.purge(box);
    }
  }

  for (const figure of document.querySelectorAll("figure.interactive")) {
    const button = figure.querySelector("button");
    button.hidden = false;
    button.addEventListener("click", () => toggle(figure, button));
  }

  let waiting = 0;
  const again = () => {
    cancelAnimationFrame(waiting);
    waiting = requestAnimationFrame(() => open.forEach((chart, figure) => show(figure, chart)));
  };
  window.addEventListener("resize", again);
  dark.addEventListener("change", again);
})();
