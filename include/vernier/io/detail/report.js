R"js(
'use strict';
(function () {
  var root = document.documentElement;
  function get(id) { return document.getElementById(id); }
  var canvas = get('canvas'), holder = get('points');
  if (!holder || !canvas || !canvas.getContext) { root.dataset.state = 'ready'; root.dataset.points = '0'; return; }
  var data = JSON.parse(holder.textContent), n = data.line.length, joints = data.units.length;
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
    if (chosen < 0) { picked.textContent = 'Click a point for its line and joints.'; return; }
    var name = data.files[data.file.length ? data.file[chosen] : 0], values = [];
    for (var k = 0; k < joints; ++k)
      values.push((data.joints[joints * chosen + k] / 100).toFixed(2) + ' ' + data.units[k]);
    picked.textContent = 'Line ' + data.line[chosen] + (name ? ' of ' + name : '') + ': ' +
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
)js"
