const plots = document.querySelectorAll(".plotly-graph-div");
// a finger scrolls the page
if (matchMedia("(pointer: coarse)").matches) plots.forEach(p => Plotly.relayout(p, { dragmode: false }));
// paper has another width than the window
addEventListener("beforeprint", () => plots.forEach(p => Plotly.relayout(p, { autosize: false, width: 640 })));
addEventListener("afterprint", () => plots.forEach(p => Plotly.relayout(p, { autosize: true, width: null })));
// a plot that was folded away has no size yet
document.querySelectorAll("details").forEach(d => d.addEventListener("toggle", () => d.querySelectorAll(".plotly-graph-div").forEach(p => Plotly.Plots.resize(p))));
