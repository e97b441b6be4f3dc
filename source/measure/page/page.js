// SPDX-License-Identifier: MIT
"use strict";

// A name has one colour and shape on the whole page.
const names = [];
const shapes = ["circle", "triangle", "rect", "rectRot", "star"];
const colors = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d1f", "#56b4e9", "#e69f00", "#444444", "#7a3db8", "#b22222"];

function axis(one) {
  return {
    type: one.is_logarithmic ? "logarithmic" : "linear",
    title: { display: true, text: one.title },
    ticks: one.is_logarithmic ? { callback: (value) => /^[125]/.test(Number(value).toExponential()) && Number(value.toPrecision(1)) === value ? String(Number(value.toPrecision(3))) : "" } : {},
  };
}

function dataset(series) {
  if (!series.is_marked && !names.includes(series.name)) {
    names.push(series.name);
  }
  const index = names.indexOf(series.name);
  const color = series.is_marked ? "#000000" : colors[index % colors.length];
  return {
    pointStyle: series.is_marked ? "circle" : shapes[Math.floor(index / colors.length) % shapes.length],
    label: series.name,
    data: series.points,
    showLine: series.is_line,
    borderColor: color,
    borderWidth: series.is_marked ? 2 : 1.2,
    backgroundColor: series.is_marked ? "transparent" : color,
    pointRadius: series.is_marked ? 8 : series.points.length > 40 ? 0 : 3.5,
    pointHitRadius: 6,
    tension: 0,
    order: series.is_marked ? 0 : 1,
  };
}

for (const figure of document.querySelectorAll("figure.chart")) {
  const spec = JSON.parse(figure.querySelector("script").textContent);
  new Chart(figure.querySelector("canvas"), {
    type: "scatter",
    data: { datasets: spec.series.map(dataset) },
    options: {
      animation: false,
      maintainAspectRatio: false,
      scales: { x: axis(spec.x), y: axis(spec.y) },
      plugins: {
        legend: { position: "right", labels: { usePointStyle: true } },
        tooltip: {
          callbacks: {
            label: (item) => [item.dataset.label + (item.raw.label ? ", " + item.raw.label : ""),
              spec.x.title + " " + item.raw.x.toPrecision(4), spec.y.title + " " + item.raw.y.toPrecision(4)],
          },
        },
      },
    },
  });
}

// Two pictures on top of each other: left of the pointer the first, right of it the second.
for (const figure of document.querySelectorAll("figure.compare")) {
  const pictures = [...figure.querySelectorAll("img")];
  const stack = document.createElement("div");
  stack.className = "stack";
  const edge = document.createElement("div");
  edge.className = "edge";
  const [under, over] = [new Image(), new Image()];
  over.className = "over";
  stack.append(under, over, edge);
  const choice = document.createElement("div");
  choice.className = "choice";
  const select = (image, first) => {
    const list = document.createElement("select");
    for (const picture of pictures) {
      list.add(new Option(picture.alt));
    }
    const show = () => { image.src = pictures[list.selectedIndex].src; };
    list.selectedIndex = Math.min(first, pictures.length - 1);
    list.addEventListener("change", show);
    show();
    return list;
  };
  choice.append("left", select(over, 0), "right", select(under, 1));
  const split = (share) => {
    over.style.clipPath = `inset(0 ${100 * (1 - share)}% 0 0)`;
    edge.style.left = `${100 * share}%`;
  };
  stack.addEventListener("pointermove", (event) => {
    const box = stack.getBoundingClientRect();
    split(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
  });
  split(0.5);
  pictures.forEach((picture) => picture.remove());
  figure.append(choice, stack);
}
