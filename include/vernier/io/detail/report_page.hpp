#pragma once

/// @file
/// The script and the style of a report, the same in all.

#include <string_view>

namespace vernier::detail {

/// Turns the view of poses: pointer, keys, buttons and the fragment of the address.
inline constexpr std::string_view report_script = R"js('use strict';
(function () {
  var root = document.documentElement;
  function get(id) { return document.getElementById(id); }
  var canvas = get('canvas'), holder = get('points');
  if (!holder || !canvas || !canvas.getContext) { root.dataset.state = 'ready'; root.dataset.points = '0'; return; }
  var data = JSON.parse(holder.textContent), n = data.row.length, joints = data.units.length;
  var pen = canvas.getContext('2d'), picked = get('picked');
  var state = {rotate: 35, tilt: 25, show: 'after'}, chosen = -1, seen = [], order = [], drag = null;

  function rotation() {
    var a = state.rotate * Math.PI / 180, b = state.tilt * Math.PI / 180;
    var ca = Math.cos(a), sa = Math.sin(a), cb = Math.cos(b), sb = Math.sin(b);
    // right, up, towards the viewer: z stays upright
    return [[ca, sa, 0], [-sb * sa, sb * ca, cb], [cb * sa, -cb * ca, sb]];
  }
  function apply(m, p) {
    return m.map(function (r) { return r[0] * p[0] + r[1] * p[1] + r[2] * p[2]; });
  }
  function level(i) {
    var share = data.clip[state.show] > 0 ? data[state.show][i] / data.clip[state.show] : 0;
    return Math.max(0, Math.min(7, Math.floor(8 * share)));
  }
  function line(from, to, width, colour) {
    pen.strokeStyle = colour; pen.lineWidth = width;
    pen.beginPath(); pen.moveTo(from[0], from[1]); pen.lineTo(to[0], to[1]); pen.stroke();
  }
  function draw() {
    var ratio = window.devicePixelRatio || 1, w = canvas.clientWidth || 640, h = canvas.clientHeight || 420;
    canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    var ink = getComputedStyle(canvas).color, m = rotation(), scale = 0.25 * Math.min(w, 1.5 * h) / data.half, i;
    seen = []; order = [];
    for (i = 0; i < n; ++i) {
      var p = [0, 1, 2].map(function (k) { return data.xyz[3 * i + k] - data.centre[k]; }), q = apply(m, p);
      seen.push([w / 2 + scale * q[0], h / 2 - scale * q[1], q[2]]);
      order.push(i);
    }
    order.sort(function (a, b) { return seen[a][2] - seen[b][2] || a - b; });
    ['x', 'y', 'z'].forEach(function (name, k) {
      var e = [0, 0, 0]; e[k] = 1;
      var d = apply(m, e), o = [46, h - 46], t = [o[0] + 30 * d[0], o[1] - 30 * d[1]];
      line(o, t, 1.5, ink);
      pen.fillStyle = ink; pen.font = '12px sans-serif';
      pen.fillText(name, o[0] + 38 * d[0] - 3, o[1] - 38 * d[1] + 4);
    });
    order.forEach(function (i) {
      var c = level(i);
      pen.fillStyle = data.colours[c];
      pen.beginPath(); pen.arc(seen[i][0], seen[i][1], 2 + 0.35 * c, 0, 2 * Math.PI); pen.fill();
    });
    if (chosen >= 0) {
      pen.strokeStyle = ink; pen.lineWidth = 2;
      pen.beginPath(); pen.arc(seen[chosen][0], seen[chosen][1], 8, 0, 2 * Math.PI); pen.stroke();
    }
    ['before', 'after'].forEach(function (name) {
      get('show-' + name).setAttribute('aria-pressed', String(state.show === name));
      get('scale-' + name).hidden = state.show !== name;
    });
  }
  function say() {
    if (chosen < 0) { picked.textContent = 'Click a point for its row and joints.'; return; }
    var name = data.files[data.file.length ? data.file[chosen] : 0], values = [];
    for (var k = 0; k < joints; ++k)
      values.push((data.joints[joints * chosen + k] / 100).toFixed(2) + ' ' + data.units[k]);
    picked.textContent = 'Row ' + data.row[chosen] + (name ? ' of ' + name : '') + ': ' +
      (data.after[chosen] / 1000).toFixed(3) + ' mm after, ' + (data.before[chosen] / 1000).toFixed(3) +
      ' mm before; joints ' + values.join(', ');
  }
  function read() {
    location.hash.slice(1).split('&').forEach(function (part) {
      var pair = part.split('='), value = parseFloat(pair[1]);
      if (pair.length !== 2) return;
      if ((pair[0] === 'rotate' || pair[0] === 'tilt') && isFinite(value)) state[pair[0]] = value;
      if (pair[0] === 'show' && (pair[1] === 'before' || pair[1] === 'after')) state.show = pair[1];
    });
  }
  function turn(a, b) {
    state.rotate = (state.rotate + a) % 360;
    state.tilt = Math.max(-90, Math.min(90, state.tilt + b));
    draw();
  }
  function keep() {
    try {
      history.replaceState(null, '', '#rotate=' + Math.round(state.rotate) + '&tilt=' + Math.round(state.tilt) +
        '&show=' + state.show);
    } catch (ignored) { return; }
  }
  canvas.addEventListener('pointerdown', function (e) {
    drag = {x: e.clientX, y: e.clientY, moved: 0};
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener('pointermove', function (e) {
    if (!drag) return;
    var dx = e.clientX - drag.x, dy = e.clientY - drag.y;
    drag = {x: e.clientX, y: e.clientY, moved: drag.moved + Math.abs(dx) + Math.abs(dy)};
    turn(-0.5 * dx, 0.5 * dy);
  });
  canvas.addEventListener('pointerup', function (e) {
    var box = canvas.getBoundingClientRect(), best = 15 * 15;
    if (drag && drag.moved < 4) {
      chosen = -1;
      order.forEach(function (i) {
        var dx = seen[i][0] - (e.clientX - box.left), dy = seen[i][1] - (e.clientY - box.top), d = dx * dx + dy * dy;
        if (d <= best) { best = d; chosen = i; }
      });
      say(); draw();
    } else keep();
    drag = null;
  });
  canvas.addEventListener('keydown', function (e) {
    var step = {ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5]}[e.key];
    if (!step) return;
    e.preventDefault(); turn(step[0], step[1]); keep();
  });
  ['before', 'after'].forEach(function (name) {
    get('show-' + name).addEventListener('click', function () { state.show = name; draw(); keep(); });
  });
  window.addEventListener('hashchange', function () { read(); draw(); });
  window.addEventListener('resize', draw);
  get('view').hidden = false;
  root.classList.add('live');
  read(); say(); draw();
  root.dataset.state = 'ready'; root.dataset.points = String(n);
})();
)js";

/// Colours by custom properties, so that the dark and the printed page differ in them alone.
inline constexpr std::string_view report_style = R"css(:root{color-scheme:light dark;--paper:#fff;--ink:#1d1d1f;
--faint:#6b6b70;--rule:#d9d9de;--panel:#f6f6f8;--link:#0b57a4;--good:#0b57a4;--bad:#b3360b;
--c0:#8a8a90;--c1:#2f6fb5;--c2:#d9730d;--c3:#5b8c5a;--c4:#8a5fa8;--c5:#a8435f}
@media (prefers-color-scheme:dark){:root{--paper:#161618;--ink:#e9e9ec;--faint:#a2a2a8;--rule:#3a3a40;--panel:#212125;
--link:#7db4f0;--good:#7db4f0;--bad:#ff9a66;--c0:#9a9aa0;--c1:#6aa7e8;--c2:#f39a45;--c3:#8cc48a;--c4:#bd95da;--c5:#e0809a}}
body{margin:0 auto;max-width:1040px;padding:1.2rem 1rem 4rem;background:var(--paper);color:var(--ink);
font:15px/1.5 system-ui,sans-serif}
h1{font-size:1.5rem;margin:0 0 .3rem}h2{font-size:1.15rem;margin:2.2rem 0 .6rem;border-bottom:1px solid var(--rule)}
h3{font-size:1rem;margin:1.2rem 0 .3rem}a{color:var(--link)}p{margin:.4rem 0;max-width:76ch}
.verdict{font-size:1.15rem;padding:.8rem 1rem;background:var(--panel);border-left:5px solid var(--faint);max-width:none}
.verdict.yes{border-color:var(--good)}.verdict.no{border-color:var(--bad)}.faint{color:var(--faint)}
nav a{margin-right:.9rem;white-space:nowrap}.wide{overflow-x:auto}
table{border-collapse:collapse;margin:.5rem 0;font-variant-numeric:tabular-nums}caption{text-align:left;color:var(--faint)}
th,td{padding:.15rem .7rem .15rem 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--rule)}
.num td,.num thead th+th{text-align:right}.num td.text,.num thead th.text{text-align:left}th{font-weight:600}tbody th{font-weight:400}
svg.chart{width:100%;max-width:760px;height:auto;display:block}svg.legend{width:100%;max-width:640px;height:auto;display:block}
.three{display:grid;grid-template-columns:repeat(3,1fr);gap:.5rem}svg.flat{width:100%;height:auto;background:var(--panel)}
.live .three,.live .plain{display:none}.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(400px,1fr));gap:.5rem 1rem}
canvas{display:block;width:100%;height:420px;background:var(--panel);color:var(--ink);touch-action:none;cursor:grab}
button{font:inherit;padding:.2rem .8rem;border:1px solid var(--rule);background:var(--panel);color:var(--ink)}
button[aria-pressed=true]{background:var(--ink);color:var(--paper)}
.tick{font:12px system-ui,sans-serif;fill:var(--faint)}.mid{text-anchor:middle}.end{text-anchor:end}
.big{font:34px system-ui,sans-serif;fill:var(--faint)}
.grid{stroke:var(--rule);fill:none}.bar{stroke:var(--faint);fill:none}.line{fill:none;stroke-width:1.6}.sticks{fill:none;stroke-width:1.2}
.key{fill:none;stroke-width:4}.band{stroke:none;opacity:.3}
.c0{stroke:var(--c0)}.c1{stroke:var(--c1)}.c2{stroke:var(--c2)}.c3{stroke:var(--c3)}.c4{stroke:var(--c4)}.c5{stroke:var(--c5)}
.band.c0{fill:var(--c0)}.band.c1{fill:var(--c1)}.band.c2{fill:var(--c2)}.band.c3{fill:var(--c3)}
code{overflow-wrap:anywhere}
@media print{:root{--paper:#fff;--ink:#000;--faint:#444;--rule:#bbb;--panel:#fff;--link:#000}
nav,#view{display:none}.live .three{display:grid}.live .plain{display:block}section{break-inside:avoid-page}body{max-width:none;font-size:11pt}}
)css";

}  // namespace vernier::detail
