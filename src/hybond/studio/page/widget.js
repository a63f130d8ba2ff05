// node_modules/preact/dist/preact.mjs
var e, t, n, r, i, a, o, s, c, l, u = Symbol.for("pv"), d = {}, f = [], p = /^m(i|n|o|s|text|space)$/, m = Array.isArray, h = f.slice, g = Object.assign;
function _(e) {
	e && e.parentNode && e.remove();
}
function v(e, t, n) {
	var r, i, a, o = {}, s = arguments.length;
	for (a in t) a == "key" ? r = t[a] : a == "ref" && typeof e != "function" ? i = t[a] : o[a] = t[a];
	return s > 2 && (o.children = s > 3 ? h.call(arguments, 2) : n), y(e, o, r, i, null);
}
function y(n, r, i, a, o) {
	var s = {
		type: n,
		props: r,
		key: i,
		ref: a,
		__k: null,
		__: null,
		__b: 0,
		__e: null,
		__c: null,
		constructor: u,
		__v: o || ++t,
		__i: -1,
		__u: 0
	};
	return !o && e.vnode && e.vnode(s), s;
}
function b() {
	return { current: null };
}
function x(e) {
	return e.children;
}
function S(e, t) {
	this.props = e, this.context = t, this.__g = 0;
}
function C(e, t) {
	if (t == null) return e.__ && C(e.__, e.__i + 1);
	for (var n; t < e.__k.length; t++) if ((n = e.__k[t]) && n.__e) return n.__e;
	return typeof e.type != "function" || e.props.__P ? null : C(e);
}
function w(t) {
	var n, r = t.__v, i = r.__e, a = [], o = [], s = t.__P;
	s && ((n = g({ constructor: u }, r)).__v = r.__v + 1, e.vnode && e.vnode(n), ne(s, n, r, t.__n, s.namespaceURI, 32 & r.__u ? [i] : null, a, i || C(r), 32 & r.__u, o), n.__v = r.__v, n.__.__k[n.__i] = n, N(a, n, o), r.__ = r.__e = null, n.__e != i && T(n));
}
function T(e) {
	if ((e = e.__) && e.__c && !e.props.__P) return e.__e = null, e.__k.some(function(t) {
		return t && (e.__e = t.__e);
	}), T(e);
}
function E(t) {
	(8 & t.__g || (t.__g |= 8, n.push(t), i++)) && r == e.debounceRendering || ((r = e.debounceRendering) || queueMicrotask)(D);
}
function D() {
	try {
		for (var e, t = 1; n.length;) n.length > t && n.sort(a), e = n.shift(), t = n.length, 8 & e.__g && w(e);
	} finally {
		(i = n.length) && (r || queueMicrotask)(D);
	}
}
function O(e, t, n, r, i, a, o, s, c, l, u) {
	var p, m, h, g, _, v, y = r.__k || f, b = t.length;
	for (c = k(n, t, y, c, b), p = 0; p < b; p++) (h = n.__k[p]) != null && (m = ~h.__i && y[h.__i] || d, h.__i = p, v = ne(e, h, m, i, a, o, s, c, l, u), g = h.__e, (m.ref != h.ref || 8 & m.__u) && (m.ref && F(m.ref, null, h, m), h.ref && u.push(h.ref, h.__c || g, h)), _ ||= g, 4 & h.__u ? (c = A(h, c, e, !m.__v), m.__e && (m.__e = null)) : typeof h.type == "function" && v !== void 0 ? c = v : g && (c = g.nextSibling), h.__u &= -21);
	return n.__e = _, c;
}
function k(e, t, n, r, i) {
	var a, o, s, c, l, d, f, p, h, g = n.length, _ = g, v = 0, b = 0, S = e.__k = Array(i);
	for (a = 0; a < i; a++) (o = t[a]) != null && typeof o != "boolean" && typeof o != "function" ? (typeof o != "object" || o.constructor === String ? o = S[a] = y(null, o) : m(o) ? o = S[a] = y(x, { children: o }) : o.constructor === u && o.__b ? o = S[a] = y(o.type, o.props, o.key, o.ref, o.__v) : S[a] = o, c = a + v, o.__ = e, o.__b = e.__b + 1, s = null, ~(l = o.__i = j(o, n, c, _)) && (_--, (s = n[l]) && (s.__u |= 2)), s && s.__v ? (o.__u |= 16, l == c - 1 ? v-- : l == c + 1 ? v++ : l != c && (l > c ? v-- : v++, b = 1)) : (~l || (i > g ? v-- : i < g && v++), typeof o.type != "function" && (o.__u |= 4))) : S[a] = null;
	if (b) {
		for (d = [], f = [], a = 0; a < i; a++) if ((o = S[a]) && 16 & o.__u) {
			for (v = 0, p = d.length; v < p;) d[h = v + p >> 1] < o.__i ? v = h + 1 : p = h;
			d[v] = o.__i, f[a] = v + 1;
		}
		for (v = d.length; a--;) f[a] && (f[a] == v ? v-- : S[a].__u |= 4);
	}
	if (_) for (a = 0; a < g; a++) !(s = n[a]) || 2 & s.__u || (s.__e == r && (r = C(s)), ae(s, s));
	return r;
}
function A(e, t, n, r) {
	var i, a, o, s;
	if (typeof e.type == "function") {
		if (e.props.__P) return t;
		if (i = e.__k) for (a = 0; a < i.length; a++) i[a] && (i[a].__ = e, t = A(i[a], t, n, !1));
		return t;
	}
	for (t && !t.parentNode && (t = C(e)) && !t.parentNode && (t = null), o = e.__e, s = t; s && s.nodeType == 8;) s = s.nextSibling;
	for (o != s && (!r && n.moveBefore && o.parentNode ? n.moveBefore(o, t) : n.insertBefore(o, t || null)), t = o; (t &&= t.nextSibling) && t.nodeType == 8 && !t.data.startsWith("$s"););
	return t;
}
function j(e, t, n, r) {
	var i, a = e.key, o = e.type, s = t[n], c = s && !(2 & s.__u);
	if (s === null && a == null || c && a == s.key && o == s.type) return n;
	if (r > +!!c) {
		for (i = n - 1; i >= 0; i--) if ((s = t[i]) && !(2 & s.__u) && a == s.key && o == s.type) return i;
		for (i = n + 1; i < t.length; i++) if ((s = t[i]) && !(2 & s.__u) && a == s.key && o == s.type) return i;
	}
	return -1;
}
function M(e, t, n) {
	n ??= "", t[0] == "-" ? e.setProperty(t, n) : e[t] = n;
}
function ee(e, t, n, r, i) {
	var a, o;
	if (t == "style") {
		if (typeof n == "string") e.style.cssText = n;
		else {
			if (typeof r == "string" && (e.style.cssText = r = ""), r) for (t in r) n && t in n || M(e.style, t);
			if (n) for (t in n) r && n[t] == r[t] || M(e.style, t, n[t]);
		}
	} else if (t[0] == "o" && t[1] == "n") typeof n != "function" && (n = null), typeof r != "function" && (r = null), (e.__e ||= {})[t] = n, n && r || (o = l[t] || (l[t] = te(t)), (e.__a ||= {})[t] = c, a = t != (t = t.replace(s, "$1")), (t = t.slice(2))[0] < "a" && (t = t.toLowerCase()), n ? e.addEventListener(t, o, a) : e.removeEventListener(t, o, a));
	else {
		if (i == "http://www.w3.org/2000/svg") t = t.replace(/xlink(H|:h)/, "h").replace(/sName$/, "s");
		else if (t != "width" && t != "height" && t != "href" && t != "list" && t != "form" && t != "tabIndex" && t != "download" && t != "rowSpan" && t != "colSpan" && t != "role" && t != "popover" && t in e) try {
			e[t] = n ?? "";
			return;
		} catch {}
		if (typeof n == "function") return;
		n == null || !1 === n && t[4] != "-" ? e.removeAttribute(t) : e.setAttribute(t, t == "popover" && n == 1 ? "" : n);
	}
}
function te(t) {
	return function(n) {
		var r = this.__e;
		if (r) {
			if (r = r[t], n[o] == null) n[o] = c++;
			else if (n[o] < this.__a[t]) return;
			return r(e.event ? e.event(n) : n);
		}
	};
}
function ne(t, n, r, i, a, o, s, c, l, d) {
	var p, h, v, y, b, w, T, E, D, k, A, j, M, ee, te, ne, N, F, L = n.type;
	if (n.constructor !== u) return null;
	128 & r.__u && (l = 32 & r.__u, p = r.__c.__z) && (n.__u |= l, h = o = [], p.nodeType == 8 ? c = re(p, o) : o.push(p), c = o[0] || c), (p = e.__b) && p(n);
	n: if (typeof L == "function") {
		v = s.length;
		try {
			if (E = n.props, D = (p = L.prototype) && p.render, k = (p = L.contextType) && i[p.__c], A = p ? k ? k.props.value : p.__ : i, (y = r.__c) ? (n.__c = y, 2 & y.__g && (y.__g |= 1)) : (D ? n.__c = y = new L(E, A) : (n.__c = y = new S(E, A), y.constructor = L, y.render = I), k && k.sub(y), y.state || (y.state = {}), y.__n = i, y.__g |= 8, y.__h = [], y.__k = []), D && (y.__s || (y.__s = y.state), L.getDerivedStateFromProps && (y.__s == y.state && (y.__s = g({}, y.__s)), g(y.__s, L.getDerivedStateFromProps(E, y.__s)))), b = y.props, w = y.state, y.__v = n, r.__c) {
				if (E !== b && D && !L.getDerivedStateFromProps && y.componentWillReceiveProps && y.componentWillReceiveProps(E, A), n.__v == r.__v && !(8 & y.__g) || !(4 & y.__g) && y.shouldComponentUpdate && !1 === y.shouldComponentUpdate(E, y.__s, A)) {
					n.__v != r.__v && (y.props = E, y.state = y.__s, y.__g &= -9), n.__e = r.__e, n.__k = r.__k, n.__k.some(function(e) {
						e && (e.__ = n);
					}), f.push.apply(y.__h, y.__k), y.__k = [], y.__h.length && s.push(y), c = C(r);
					break n;
				}
				y.componentWillUpdate && y.componentWillUpdate(E, y.__s, A), D && y.componentDidUpdate && y.__h.push(function() {
					y.componentDidUpdate(b, w, T);
				});
			} else D && !L.getDerivedStateFromProps && y.componentWillMount && y.componentWillMount(), D && y.componentDidMount && y.__h.push(y.componentDidMount);
			y.context = A, y.props = E, y.__P = t, y.__g &= -5, j = e.__r, M = D ? 25 : 0;
			do
				y.__g &= -9, j && j(n), p = y.render(y.props, y.state = y.__s, y.context);
			while (8 & y.__g && ++M < 25);
			D && (f.push.apply(y.__h, y.__k), y.__k = []), y.state = y.__s, y.getChildContext && (i = g({}, i, y.getChildContext())), D && r.__c && y.getSnapshotBeforeUpdate && (T = y.getSnapshotBeforeUpdate(b, w)), ee = p && p.type === x && p.key == null ? p.props.children : p, E.__P && (p = c, a = (t = E.__P).namespaceURI, l = o = null, r.props && r.props.__P != t && (r.__k.some(function(e) {
				e && ae(e, e);
			}), r.__k = null), c = r.__k ? C(r, 0) : null), c = O(t, m(ee) ? ee : [ee], n, r, i, a, o, s, c, l, d), E.__P && (n.__e = null, c = p), n.__u &= -161, h && h.some(_), y.__h.length && s.push(y), 1 & y.__g && (y.__g &= -4);
		} catch (t) {
			if (s.length = v, n.__v = null, l || o) {
				if (t && t.then) {
					if (n.__u |= 128 | l, o) {
						for (~(N = o.indexOf(c || void 0)) || (N = o.length); (F = o[N - 1]) && F.nodeType == 8;) N--;
						for (; N < o.length; N++) if (F = o[N]) {
							if (o[N] = null, te) {
								if (F == ne) break;
							} else {
								if (F.nodeType != 8) break;
								F.data.startsWith("$s") && (ne = re(te = F));
							}
						}
					}
					if (!te) {
						for (; c && c.nodeType == 8 && c.nextSibling;) c = c.nextSibling;
						te = c;
					}
					(p = re(te = n.__c.__z || (n.__c.__z = te))) ? (n.__e = te, c = p) : n.__e = c, c &&= c.nextSibling;
				} else o && o.some(_);
			} else n.__e = r.__e;
			n.__k ||= r.__k || [], t && t.then || ie(n), e.__e(t, n, r);
		}
	} else c = n.__e = P(r.__e, n, r, i, a, o, s, l, d, t);
	return (p = e.diffed) && p(n), c;
}
function re(e, t) {
	if (e && e.nodeType == 8 && e.data.startsWith("$s")) for (var n = 1; e = e.nextSibling;) {
		if (e.nodeType == 8) {
			if (e.data.startsWith("$s")) n++;
			else if (e.data.startsWith("/$s") && !--n) return e;
		}
		t && t.push(e);
	}
}
function ie(e) {
	e && (e.__c && (e.__c.__g |= 4), e.__k && e.__k.some(ie));
}
function N(t, n, r) {
	for (var i = 0; i < r.length;) F(r[i++], r[i++], r[i++]);
	e.__c && e.__c(n, t), t.some(function(n) {
		try {
			t = n.__h, n.__h = [], t.some(function(e) {
				e.call(n);
			});
		} catch (t) {
			e.__e(t, n.__v);
		}
	});
}
function P(t, n, r, i, a, o, s, c, l, u) {
	var f, g, v, y, b, x, S, w, T = r.props || d, E = n.props, D = n.type;
	if (D == "svg" ? a = "http://www.w3.org/2000/svg" : D == "math" ? a = "http://www.w3.org/1998/Math/MathML" : a ||= "http://www.w3.org/1999/xhtml", o) {
		for (f = 0; f < o.length; f++) if ((b = o[f]) && (D ? b.localName == D : b.nodeType == 3)) {
			t = b, o[f] = null;
			break;
		}
	}
	if (!t) {
		if (w = u.ownerDocument || document, !D) return w.createTextNode(E);
		t = w.createElementNS(a, D, E.is ? E : u), c &&= (e.__m && e.__m(n, o), !1), o = null;
	}
	if (D) {
		if (u = D == "template" && t.content || t, o = D == "textarea" && E.defaultValue != null ? null : o && h.call(u.childNodes), !c && o) for (T = {}, f = 0; f < t.attributes.length; f++) T[(b = t.attributes[f]).name] = b.value;
		for (f in T) b = T[f], f == "dangerouslySetInnerHTML" ? v = b : f == "children" || f in E || f == "value" && "defaultValue" in E || f == "checked" && "defaultChecked" in E || ee(t, f, null, b, a);
		for (f in E) b = E[f], f == "children" ? y = b : f == "dangerouslySetInnerHTML" ? g = b : f == "value" ? x = b : f == "checked" ? S = b : c && typeof b != "function" || T[f] === b || ee(t, f, b, T[f], a);
		g ? (c || v && (g.__html == v.__html || g.__html == t.innerHTML) || (t.innerHTML = g.__html), n.__k = []) : (v && (t.textContent = ""), (D == "foreignObject" || a == "http://www.w3.org/1998/Math/MathML" && p.test(D)) && (a = "http://www.w3.org/1999/xhtml"), O(u, m(y) ? y : [y], n, r, i, a, o, s, o ? o[0] : r.__k && C(r, 0), c, l), o && o.some(_)), c && D != "textarea" || (f = "value", D == "progress" && x == null ? t.removeAttribute(f) : x == null || x === t[f] && (D != "progress" || x) || ee(t, f, x, T[f], a), f = "checked", S != null && S != t[f] && ee(t, f, S, T[f], a));
	} else T === E || c && t.data == E || (t.data = E);
	return t;
}
function F(t, n, r, i) {
	try {
		typeof t == "function" ? n ? n.__x = t(n) || 1 : (i &&= i.__c || i.__e) && (n = i.__x) && (i.__x = null, typeof n == "function" ? n() : t(null)) : t.current = n;
	} catch (t) {
		e.__e(t, r);
	}
}
function ae(t, n, r) {
	var i, a, o, s;
	if (e.unmount && e.unmount(t), !(i = t.ref) || i.current && i.current != t.__e || F(i, null, n, t), i = t.__c) {
		if (i.componentWillUnmount) try {
			i.componentWillUnmount();
		} catch (t) {
			e.__e(t, n);
		}
		i.__P = i.__n = null;
	}
	if (i = t.__k) for (s = 0; s < i.length; s++) i[s] && ae(i[s], n, typeof t.type != "function" || r && !t.props.__P);
	!r && (i = t.__c) && (i = i.__z) && (a = re(i, o = [])) && (i == t.__e && o.some(_), _(a), _(i)), r || _(t.__e), t.__e = t.__c = t.__ = null;
}
function I(e, t, n) {
	return this.constructor(e, n);
}
function L(t, n) {
	var r, i, a, o;
	e.__ && e.__(t, n), n.nodeType == 9 && (n = n.documentElement), i = (r = t && 32 & t.__u) ? null : n.__k, n.__k = y(x, { children: [t] }), a = [], o = [], ne(n, n.__k, i || d, d, n.namespaceURI, i ? null : n.firstChild ? h.call(n.childNodes) : null, a, i ? i.__e : n.firstChild, r, o), N(a, n.__k, o), n.__k.props.children = null;
}
e = { __e: function(e, t, n, r) {
	for (var a, o, s; t = t.__;) if ((a = t.__c) && !(1 & a.__g)) {
		a.__g |= 4;
		try {
			if ((s = (o = a.constructor) && o.getDerivedStateFromError) && a.setState(o.getDerivedStateFromError(e)), a.componentDidCatch && (a.componentDidCatch(e, r || {}), s = 1), s && 8 & a.__g) return void (a.__g |= 2);
		} catch (t) {
			e = t;
		}
	}
	throw i = 0, e;
} }, t = 0, S.prototype.setState = function(e, t) {
	var n = this.__s;
	n && n != this.state || (n = this.__s = g({}, this.state)), typeof e == "function" && (e = e(g({}, n), this.props)), e && (g(n, e), this.__v && (t && this.__k.push(t), E(this)));
}, S.prototype.forceUpdate = function(e) {
	this.__v && (this.__g |= 4, e && this.__h.push(e), E(this));
}, S.prototype.render = x, n = [], i = 0, a = function(e, t) {
	return e.__v.__b - t.__v.__b;
}, o = Symbol(), s = /(PointerCapture)$|Capture$/i, c = 0, l = {};
// src/geometry.ts
var oe = 5.5, se = 35 * Math.PI / 180;
function ce(e, t) {
	return {
		x0: e.x0 - t,
		y0: e.y0 - t,
		x1: e.x1 + t,
		y1: e.y1 + t
	};
}
function le(e, [t, n]) {
	let r = 0, i = 1, a = [[
		t[0],
		n[0] - t[0],
		e.x0,
		e.x1
	], [
		t[1],
		n[1] - t[1],
		e.y0,
		e.y1
	]];
	for (let [e, t, n, o] of a) {
		if (t === 0) {
			if (!(n < e && e < o)) return null;
			continue;
		}
		let a = (n - e) / t, s = (o - e) / t;
		r = Math.max(r, Math.min(a, s)), i = Math.min(i, Math.max(a, s));
	}
	return r < i ? [r, i] : null;
}
function ue(e, t) {
	let n = Math.hypot(e, t), r = -t / n, i = e / n;
	return (Math.abs(e) >= Math.abs(t) ? i > 0 : r < 0) ? [r + 0, i + 0] : [-r + 0, -i + 0];
}
function de(e, t, n, r, i = 0) {
	let a = r[0] - n[0], o = r[1] - n[1], s = Math.hypot(a, o);
	if (s === 0) return {
		tail: n,
		head: r,
		barb: [r, r]
	};
	let [c, l] = ue(a, o), u = [n[0] + i * c, n[1] + i * l], d = [r[0] + i * c, r[1] + i * l], f = le(ce(e, oe), [u, d]), p = le(ce(t, oe), [u, d]), m = f ? f[1] : 0, h = p ? p[0] : 1;
	h <= m && (m = .35, h = .65);
	let g = [u[0] + m * a, u[1] + m * o], _ = [u[0] + h * a, u[1] + h * o], v = a / s, y = o / s, b = Math.min(11, .5 * s * (h - m)), x = b * Math.cos(se), S = b * Math.sin(se);
	return {
		tail: g,
		head: _,
		barb: [_, [_[0] - x * v + S * c, _[1] - x * y + S * l]]
	};
}
function fe(e, t) {
	let n = e.head[0] - e.tail[0], r = e.head[1] - e.tail[1];
	if (n === 0 && r === 0) return [e.head, e.head];
	let [i, a] = ue(n, r), [o, s] = t ? e.head : e.tail, c = 15 / 2;
	return [[o + c * i, s + c * a], [o - c * i, s - c * a]];
}
var pe = /* @__PURE__ */ new Set([..."iljI|.,:;'!()[]{}/\\ ·‹›-ftr\"²³°"]), me = /* @__PURE__ */ new Set([..."mwMW@%…+=<>~ΩQOGD&→δ_"]);
function he(e, t, n = !1) {
	let r = 0;
	for (let t of e) pe.has(t) ? r += .42 : me.has(t) ? r += .88 : t !== t.toLowerCase() && t === t.toUpperCase() ? r += .7 : r += (t.codePointAt(0) ?? 0) < 11904 ? .64 : 1.05;
	return r * t * (n ? 1.1 : 1);
}
var ge = .73;
function _e(e, t, [n, r]) {
	let i = Math.max(he(e, 19, !0) / 2, 6);
	t && (i += 6);
	let a = {
		x0: n - i,
		y0: r - ge * 19 / 2 - 1,
		x1: n + i,
		y1: r + ge * 19 / 2 + (t ? 3 : 1)
	};
	return t ? ce(a, 2) : a;
}
function ve(e, t) {
	let n = /* @__PURE__ */ new Set();
	for (let [r, i] of t) {
		let t = r - e[0], a = i - e[1];
		Math.abs(a) >= .3 * Math.abs(t) && n.add(a > 0 ? "s" : "n"), Math.abs(t) >= .3 * Math.abs(a) && n.add(t > 0 ? "e" : "w");
	}
	return n;
}
// node_modules/preact/jsx-runtime/dist/jsxRuntime.mjs
var ye = Symbol.for("pv"), be = 0;
Array.isArray;
function R(t, n, r, i, a, o) {
	n ||= {};
	var s, c, l = n;
	if ("ref" in l && typeof t != "function") for (c in l = {}, n) c == "ref" ? s = n[c] : l[c] = n[c];
	var u = {
		type: t,
		props: l,
		key: r,
		ref: s,
		__k: null,
		__: null,
		__b: 0,
		__e: null,
		__c: null,
		constructor: ye,
		__v: --be,
		__i: -1,
		__u: 0
	};
	return (a || o) && (u.__source = a, u.__self = o), e.vnode && e.vnode(u), u;
}
// src/shapes.tsx
var z = [100, 84];
function B(e, t) {
	return [e * z[0], t * z[1]];
}
var xe = 18;
function Se(e, t) {
	return (e.ports ?? []).map((n, r) => {
		let [i, a] = t.get(`${e.name}.${n}`) ?? [0, 0];
		return Math.abs(i) < 1 && Math.abs(a) < 1 ? r % 2 ? "e" : "w" : Math.abs(a) > 1.1 * Math.abs(i) ? a > 0 ? "s" : "n" : i > 0 ? "e" : "w";
	}).join("");
}
function Ce(e, t) {
	let n = e.ports ?? [], r = (e) => n.filter((n, r) => t[r] === e), i = (e) => Math.max(0, ...r(e).map((e) => he(e, 9))), a = (e) => r(e).reduce((e, t) => e + he(t, 9) + 10, 0), o = Math.max(r("e").length, r("w").length), s = Math.max(54, Math.min(150, he(e.letters, 10.5) + 16), i("e") + i("w") + 26, a("n"), a("s")), c = o ? -(o - 1) * xe / 2 : 0, l = o ? c - 15 : 4;
	return {
		half: s / 2,
		first: c,
		title: l,
		top: l - (r("n").length ? 27 : 15),
		bottom: (o ? -c + 11 : 12) + (r("s").length ? 13 : 0)
	};
}
function we(e, t) {
	let { half: n, first: r, top: i, bottom: a } = Ce(e, t), o = /* @__PURE__ */ new Map(), s = {
		e: 0,
		w: 0,
		n: 0,
		s: 0
	};
	return (e.ports ?? []).forEach((e, c) => {
		let l = t[c], u = s[l]++;
		if (l === "e" || l === "w") o.set(e, [l === "e" ? n : -n, r + u * xe]);
		else {
			let r = [...t].filter((e) => e === l).length;
			o.set(e, [2 * n * (u + 1) / (r + 1) - n, l === "n" ? i : a]);
		}
	}), o;
}
function Te(e, t, n, r = "") {
	if (e.kind === "part") {
		let { half: t, top: i, bottom: a } = Ce(e, r);
		return {
			x0: n[0] - t,
			y0: n[1] + i,
			x1: n[0] + t,
			y1: n[1] + a
		};
	}
	return _e(e.letters, t, n);
}
function Ee(e, t, n, r, i = "") {
	if (e.kind === "part") {
		let n = t.slice(e.name.length + 1), a = we(e, i).get(n);
		if (a) {
			let e = [r[0] + a[0], r[1] + a[1]];
			return [e, {
				x0: e[0] - 1,
				y0: e[1] - 1,
				x1: e[0] + 1,
				y1: e[1] + 1
			}];
		}
	}
	return [r, Te(e, n, r, i)];
}
var De = ([[e, t], [n, r]]) => ({
	x1: e,
	y1: t,
	x2: n,
	y2: r
});
function Oe(e, t) {
	let [n, r] = [(e.tail[0] + e.head[0]) / 2, (e.tail[1] + e.head[1]) / 2];
	return Math.abs(e.head[0] - e.tail[0]) >= Math.abs(e.head[1] - e.tail[1]) ? {
		x: n,
		y: r + (t > 0 ? -6 : 17),
		"text-anchor": "middle"
	} : {
		x: n - 9 * t,
		y: r + 4,
		"text-anchor": t > 0 ? "end" : "start"
	};
}
function ke(e, t) {
	for (let n in e) if (e[n] !== t[n]) return !0;
	return !1;
}
var Ae = class extends S {
	shouldComponentUpdate(e) {
		return ke(e, this.props);
	}
	render(e) {
		let [t, n] = Ee(e.tail, e.bond.ends[0], e.tailControlled, [e.tx, e.ty], e.tailPorts), [r, i] = Ee(e.head, e.bond.ends[1], e.headControlled, [e.hx, e.hy], e.headPorts), a = de(n, i, t, r, e.shift * 9), o = e.drawn, s = (o?.off ? " off" : "") + (o?.conflict ? " conflict" : ""), [c, l] = [(a.tail[0] + a.head[0]) / 2, (a.tail[1] + a.head[1]) / 2], u = new Set(o?.late ?? []);
		return /* @__PURE__ */ R("g", {
			class: "bond" + (e.selected ? " selected" : "") + s,
			"data-bond": e.bond.key,
			"data-text": e.bond.text,
			children: [
				/* @__PURE__ */ R("line", {
					class: "reach",
					...De([a.tail, a.head])
				}),
				e.flow !== 0 && /* @__PURE__ */ R("line", {
					class: "power",
					...De(e.flow > 0 ? [a.tail, a.head] : [a.head, a.tail]),
					style: { strokeWidth: `${2 + 5 * Math.abs(e.flow)}px` }
				}),
				/* @__PURE__ */ R("line", {
					class: "line",
					...De([a.tail, a.head])
				}),
				/* @__PURE__ */ R("line", {
					class: "line barb",
					...De(a.barb)
				}),
				o?.strokes.map((e) => /* @__PURE__ */ R("line", {
					class: "stroke" + (u.has(e) ? " derivative" : ""),
					"data-end": e,
					...De(fe(a, e))
				})),
				o?.dashed?.map((e) => /* @__PURE__ */ R("line", {
					class: "stroke dynamic" + (u.has(e) ? " derivative" : ""),
					"data-end": e,
					...De(fe(a, e))
				})),
				o?.conflict && /* @__PURE__ */ R("path", {
					class: "cross",
					d: `M${c - 4.5},${l - 4.5}l9,9m0,-9l-9,9`
				}),
				e.effort && /* @__PURE__ */ R(x, { children: [/* @__PURE__ */ R("text", {
					class: "value",
					...Oe(a, 1),
					children: e.effort
				}), /* @__PURE__ */ R("text", {
					class: "value",
					...Oe(a, -1),
					children: e.rate
				})] })
			]
		});
	}
};
function je(e, t, n) {
	return e === "n" ? {
		x: t,
		y: n + 13,
		"text-anchor": "middle"
	} : e === "s" ? {
		x: t,
		y: n - 6,
		"text-anchor": "middle"
	} : {
		x: e === "w" ? t + 6 : t - 6,
		y: n + 3,
		"text-anchor": e === "w" ? "start" : "end"
	};
}
function Me(e, t, n) {
	let r = e.node.kind === "0" || e.node.kind === "1", i = new Set(e.taken), a = [...r || e.taken === "s" ? "nsew" : "snew"].find((e) => !i.has(e)), o = n * 13, s = (t.x0 + t.x1) / 2 - e.x;
	return e.node.kind === "part" && e.ports.includes("s") ? e.ports.includes("n") ? {
		x: s + 8,
		y: t.y1 - e.y + 13,
		anchor: "start"
	} : {
		x: s,
		y: t.y0 - e.y - 4 - o + 13,
		anchor: "middle"
	} : e.node.kind === "part" || a === "s" ? {
		x: s,
		y: t.y1 - e.y + 13,
		anchor: "middle"
	} : a === "n" ? {
		x: s,
		y: t.y0 - e.y - 4 - o + 13,
		anchor: "middle"
	} : a === "e" ? {
		x: t.x1 - e.x + 4,
		y: 4 - o / 2 + 8,
		anchor: "start"
	} : a === "w" ? {
		x: t.x0 - e.x - 4,
		y: 4 - o / 2 + 8,
		anchor: "end"
	} : {
		x: 10,
		y: -10 - o + 13,
		anchor: "start"
	};
}
var Ne = class extends S {
	shouldComponentUpdate(e) {
		return ke(e, this.props);
	}
	render(e) {
		let { node: t, state: n } = e, r = n?.controlled ?? (!!t.machine || !!t.law), i = Te(t, r, [e.x, e.y], e.ports), a = "node" + (t.kind === "0" || t.kind === "1" ? " junction" : "") + (t.kind === "part" ? " part" : "") + (n?.off ? " off" : "") + (n?.derivative ? " derivative" : "") + (e.selected ? " selected" : "") + (e.target ? " target" : ""), o = n?.says ?? t.says, s = [
			{
				role: "name",
				text: t.name
			},
			...o ? [{
				role: "parameter",
				text: o
			}] : [],
			...t.machine ? [{
				role: "machine",
				text: `[${t.machine}]`
			}] : [],
			...t.law ? [{
				role: "law",
				text: t.law
			}] : [],
			...t.outside ? [{
				role: "machine",
				text: `port ${t.outside.join(", ")}`
			}] : []
		], c = Me(e, i, s.length), l = ge * 19 / 2, u = Ce(t, e.ports);
		return /* @__PURE__ */ R("g", {
			class: a,
			"data-node": t.name,
			transform: `translate(${e.x},${e.y})`,
			children: [
				t.kind === "part" ? /* @__PURE__ */ R(x, { children: [
					/* @__PURE__ */ R("rect", {
						class: "frame",
						x: -u.half,
						y: u.top,
						width: 2 * u.half,
						height: u.bottom - u.top,
						rx: 6
					}),
					/* @__PURE__ */ R("text", {
						class: "title",
						y: u.title,
						"text-anchor": "middle",
						children: t.letters
					}),
					[...we(t, e.ports)].map(([n, [r, i]], a) => /* @__PURE__ */ R("g", {
						class: "port",
						"data-port": `${t.name}.${n}`,
						children: [
							/* @__PURE__ */ R("circle", {
								class: "hit",
								cx: r,
								cy: i,
								r: 9
							}),
							/* @__PURE__ */ R("circle", {
								cx: r,
								cy: i,
								r: 3
							}),
							/* @__PURE__ */ R("text", {
								...je(e.ports[a], r, i),
								children: n
							})
						]
					}))
				] }) : /* @__PURE__ */ R(x, { children: [
					/* @__PURE__ */ R("rect", {
						class: "reach",
						x: i.x0 - e.x - 6,
						y: i.y0 - e.y - 6,
						width: i.x1 - i.x0 + 12,
						height: i.y1 - i.y0 + 12
					}),
					r && /* @__PURE__ */ R("rect", {
						class: "switch",
						x: i.x0 - e.x,
						y: i.y0 - e.y,
						width: i.x1 - i.x0,
						height: i.y1 - i.y0,
						rx: 6
					}),
					/* @__PURE__ */ R("text", {
						class: "letters",
						x: r ? -4 : 0,
						y: l,
						"text-anchor": "middle",
						children: t.letters
					}),
					r && /* @__PURE__ */ R("text", {
						class: "subscript",
						x: he(t.letters, 19, !0) / 2 - 3.5,
						y: l + 3.5,
						children: "c"
					})
				] }),
				s.map((e, t) => /* @__PURE__ */ R("text", {
					class: e.role,
					x: c.x,
					y: c.y + 13 * t,
					"text-anchor": c.anchor,
					children: e.text.length > 24 ? e.text.slice(0, 23) + "…" : e.text
				})),
				e.selected && /* @__PURE__ */ R("g", {
					class: "handle",
					"data-handle": t.name,
					children: [
						/* @__PURE__ */ R("circle", {
							class: "hit",
							cx: i.x1 - e.x + 12,
							cy: i.y0 - e.y - 8,
							r: 14
						}),
						/* @__PURE__ */ R("circle", {
							cx: i.x1 - e.x + 12,
							cy: i.y0 - e.y - 8,
							r: 6
						}),
						/* @__PURE__ */ R("path", { d: `M${i.x1 - e.x + 9},${i.y0 - e.y - 5}l6,-6m-4,0h4v4` })
					]
				})
			]
		});
	}
};
// src/sharing.ts
function Pe(e, t) {
	if (e === t || typeof t != "object" || !t || typeof e != "object" || !e || Array.isArray(e) !== Array.isArray(t)) return t;
	let [n, r] = [e, t], i = Object.keys(r), a = i.length === Object.keys(n).length;
	for (let e of i) {
		let t = Pe(n[e], r[e]);
		r[e] = t, a &&= t === n[e] && e in n;
	}
	return a ? e : t;
}
// src/transport.ts
var Fe = class extends Error {
	problem;
	constructor(e) {
		super(e.why), this.problem = e;
	}
}, Ie = class {
	count = 0;
	waiting = /* @__PURE__ */ new Map();
	held = [];
	carrier = null;
	onTold = () => {};
	client = Math.random().toString(36).slice(2, 10);
	ask(e, t = {}) {
		let n = ++this.count, r = {
			...t,
			id: n,
			ask: e,
			client: this.client
		};
		return new Promise((e, t) => {
			this.waiting.set(n, {
				done: e,
				failed: t
			}), this.carrier ? this.carrier.send(r) : this.held.push(r);
		});
	}
	connected(e) {
		this.carrier = e;
		let t = this.held;
		this.held = [];
		for (let n of t) e.send(n);
	}
	lost() {
		this.carrier = null;
		for (let { failed: e } of this.waiting.values()) e(/* @__PURE__ */ Error("the studio was left"));
		this.waiting.clear();
	}
	received(e) {
		if (typeof e.id == "number") {
			let t = this.waiting.get(e.id);
			if (this.waiting.delete(e.id), !t) return;
			e.error ? t.failed(new Fe(e.error)) : t.done(e);
		} else this.onTold(e);
	}
}, Le = {
	connected: !1,
	look: null,
	stock: null,
	level: "",
	mode: null,
	nodes: /* @__PURE__ */ new Set(),
	bonds: /* @__PURE__ */ new Set(),
	tab: "item",
	bondFrom: null,
	drawing: !1,
	notice: null,
	run: null,
	runs: [],
	running: null,
	soFar: null,
	cursor: null,
	instant: null,
	plotted: [],
	span: [0, 1],
	adding: !1,
	bottom: !1,
	panel: "",
	dark: null,
	flowing: !1
}, Re = class {
	transport;
	state = Le;
	listeners = /* @__PURE__ */ new Set();
	queue = Promise.resolve();
	constructor(e) {
		this.transport = e, e.onTold = (e) => this.told(e);
	}
	subscribe(e) {
		return this.listeners.add(e), () => this.listeners.delete(e);
	}
	set(e) {
		this.state = {
			...this.state,
			...e
		};
		for (let e of this.listeners) e();
	}
	async begin() {
		this.set({ connected: !0 }), await this.look(), this.state.stock || this.set({ stock: await this.transport.ask("stock") });
		let { runs: e } = await this.transport.ask("runs");
		this.set({ runs: e });
		let t = e[e.length - 1];
		t && !this.state.run && this.show(t);
	}
	where() {
		return {
			level: this.state.level,
			mode: this.state.mode
		};
	}
	async look() {
		await this.taking(this.transport.ask("look", this.where()));
	}
	async taking(e) {
		try {
			let t = await e;
			return this.take(t), t;
		} catch (e) {
			return this.refused(e), null;
		}
	}
	refused(e) {
		e instanceof Fe ? this.set({ notice: e.problem }) : this.state.connected && this.set({ notice: {
			code: "",
			where: "",
			why: String(e),
			try: ""
		} });
	}
	take(e) {
		let t = Pe(this.state.look, e), n = new Set(t.view.nodes.map((e) => e.name)), r = new Set(t.view.bonds.map((e) => e.key));
		this.set({
			look: t,
			level: t.view.path,
			nodes: new Set([...this.state.nodes].filter((e) => n.has(e))),
			bonds: new Set([...this.state.bonds].filter((e) => r.has(e))),
			bondFrom: this.state.bondFrom && n.has(this.state.bondFrom) ? this.state.bondFrom : null
		});
	}
	told(e) {
		if (e.tell === "changed") e.by !== this.transport.client && e.revision !== this.state.look?.revision && this.look();
		else if (e.tell === "progress") this.set({ running: e });
		else if (e.tell === "partial") this.set({ soFar: e });
		else if (e.tell === "finished") {
			let t = e;
			this.set({
				running: null,
				soFar: null,
				runs: [...this.state.runs.filter((e) => e.run !== t.run), t]
			}), this.show(t), t.error && this.set({ notice: t.error });
		} else e.tell === "saved" && this.state.look && this.set({ look: {
			...this.state.look,
			unsaved: String(e.unsaved)
		} });
	}
	show(e) {
		let t = this.state.plotted.filter((t) => e.names?.includes(t));
		this.set({
			run: e,
			plotted: t.length ? this.state.plotted : (e.plot ?? []).slice(0, 4),
			span: [e.tBegin ?? 0, e.tEnd ?? 1],
			cursor: null,
			instant: null,
			bottom: !0
		});
	}
	edit(e) {
		let t = this.queue.then(() => this.taking(this.transport.ask("edit", {
			...this.where(),
			edit: {
				level: this.state.level,
				...e
			}
		})));
		return this.queue = t, this.set({
			cursor: null,
			instant: null
		}), t;
	}
	ask(e, t = {}) {
		let n = this.queue.then(() => this.taking(this.transport.ask(e, {
			...this.where(),
			...t
		})));
		return this.queue = n, n;
	}
	undo = () => this.ask("undo");
	redo = () => this.ask("redo");
	async add(e, t, n) {
		let r = new Set(this.state.look?.view.nodes.map((e) => e.name)), i = n ?? this.freePlace(), a = (await this.edit({
			do: "add",
			element: e,
			stem: t,
			at: i
		}))?.view.nodes.find((e) => !r.has(e.name));
		a && this.set({
			nodes: /* @__PURE__ */ new Set([a.name]),
			bonds: /* @__PURE__ */ new Set(),
			tab: "item"
		});
	}
	freePlace() {
		let e = this.state.look?.view.nodes ?? [];
		if (!e.length) return [0, 0];
		let t = e.find((e) => this.state.nodes.has(e.name)) ?? e[e.length - 1], n = (t, n) => e.some((e) => Math.abs(e.x - t) < .6 && Math.abs(e.y - n) < .6), r = Math.round(t.x), i = Math.round(t.y);
		for (let [e, t] of [
			[1, 0],
			[0, -1],
			[0, 1],
			[-1, 0],
			[1, -1],
			[1, 1],
			[2, 0]
		]) if (!n(r + e, i + t)) return [r + e, i + t];
		for (let e = 3;; e++) if (!n(r + e, i)) return [r + e, i];
	}
	async bond(e, t) {
		let n = new Set(this.state.look?.view.bonds.map((e) => e.key)), r = (await this.edit({
			do: "bond",
			tail: e,
			head: t
		}))?.view.bonds.find((e) => !n.has(e.key));
		r && this.set({
			bonds: /* @__PURE__ */ new Set([r.key]),
			nodes: /* @__PURE__ */ new Set()
		}), this.set({ bondFrom: null });
	}
	remove() {
		let { nodes: e, bonds: t } = this.state;
		(e.size || t.size) && this.edit({
			do: "remove",
			names: [...e],
			bonds: [...t]
		});
	}
	reverse() {
		this.state.bonds.size && this.edit({
			do: "reverse",
			bonds: [...this.state.bonds]
		});
	}
	async copy() {
		let e = [...this.state.nodes];
		if (!e.length) return "";
		let { text: t } = await this.transport.ask("copy", {
			...this.where(),
			names: e
		});
		return t;
	}
	async duplicate() {
		let e = await this.copy();
		e && await this.paste(e);
	}
	async paste(e) {
		let t = await this.ask("paste", {
			text: e,
			by: [1, 1]
		});
		t?.pasted && this.set({
			nodes: new Set(t.pasted),
			bonds: /* @__PURE__ */ new Set()
		});
	}
	open(e) {
		this.set({
			level: e,
			nodes: /* @__PURE__ */ new Set(),
			bonds: /* @__PURE__ */ new Set(),
			cursor: null,
			instant: null
		}), this.look();
	}
	setMode(e, t) {
		let n = Object.fromEntries((this.state.look?.machines ?? []).map((e) => [e.path, e.state]));
		this.set({
			mode: {
				...n,
				[e]: t
			},
			cursor: null,
			instant: null
		}), this.look();
	}
	select(e) {
		e && (this.set({
			nodes: new Set(e.nodes ?? []),
			bonds: new Set(e.bonds ?? [])
		}), e.entry?.[0] === "machines" ? this.set({ tab: "machines" }) : e.entry && this.set({ tab: "model" }));
	}
	async start(e) {
		try {
			let { run: t } = await this.transport.ask("run", {
				...e ? { until: e } : {},
				names: this.state.plotted
			});
			this.state.runs.some((e) => e.run === t) || this.set({
				running: {
					run: t,
					t: 0,
					events: 0
				},
				soFar: null,
				bottom: !0
			});
		} catch (e) {
			this.refused(e);
		}
	}
	cancel = () => void this.transport.ask("cancel").catch(() => {});
	cursorCount = 0;
	async moveCursor(e, t = "right", n) {
		let r = this.state.run;
		if (!r) return;
		let i = ++this.cursorCount;
		try {
			let a = await this.transport.ask("cursor", {
				run: r.run,
				t: e,
				side: t,
				mode: n ?? null,
				level: this.state.level
			}), o = Pe(this.state.cursor?.strokes ?? this.state.look?.strokes, a.strokes);
			i === this.cursorCount && this.set({ cursor: {
				...a,
				strokes: o
			} });
		} catch (e) {
			this.refused(e);
		}
	}
	showInstant(e, t) {
		this.set({ instant: {
			event: e,
			step: t
		} }), this.moveCursor(e.t, t < e.steps.length - 1 ? "left" : "right", e.steps[t].mode);
	}
};
function ze(e, t = 4) {
	if (e === null) return "—";
	if (e === 0) return "0";
	let n = Math.abs(e);
	return n >= 1e5 || n < .001 ? e.toExponential(t - 1) : String(+e.toPrecision(t));
}
var Be = [
	[1e9, "G"],
	[1e6, "M"],
	[1e3, "k"],
	[1, ""],
	[.001, "m"],
	[1e-6, "µ"],
	[1e-9, "n"],
	[1e-12, "p"]
];
function Ve(e, t) {
	if (e === null) return "—";
	if (e === 0 || !/^[A-Za-zΩ]+$/.test(t) || t === "kg") return `${ze(e)} ${t}`.trim();
	let [n, r] = Be.find(([t]) => Math.abs(e) >= t * (1 - 1e-9)) ?? Be[Be.length - 1];
	return `${+(e / n).toPrecision(4)} ${r}${t}`.trim();
}
// src/canvas.tsx
var He = class extends S {
	svg = b();
	state = {
		sight: {
			x: 60,
			y: 120,
			k: 1
		},
		gesture: null,
		moved: [0, 0]
	};
	pointers = /* @__PURE__ */ new Map();
	fitted = "";
	lastTap = {
		time: 0,
		node: ""
	};
	watch = new ResizeObserver(() => this.resized());
	size = [0, 0];
	touched = !1;
	componentDidMount() {
		this.listen(), this.fitOnce();
	}
	componentWillUnmount() {
		this.watch.disconnect(), this.svg.current?.removeEventListener("wheel", this.wheel);
	}
	listening = null;
	listen() {
		let e = this.svg.current;
		e && e !== this.listening && (this.listening = e, e.addEventListener("wheel", this.wheel, { passive: !1 }), this.watch.observe(e));
	}
	resized() {
		let e = this.svg.current?.getBoundingClientRect();
		if (!e || e.width === this.size[0] && e.height === this.size[1]) return;
		let [t, n] = this.size;
		if (this.size = [e.width, e.height], !this.touched) this.fit();
		else if (t) {
			let r = this.state.sight;
			this.setState({ sight: {
				...r,
				x: r.x + (e.width - t) / 2,
				y: r.y + (e.height - n) / 2
			} });
		}
	}
	componentDidUpdate() {
		this.listen(), this.fitOnce(), this.keepInSight();
	}
	seen = "";
	keepInSight() {
		let { state: e } = this.props, t = e.look;
		if (!t || !this.svg.current || this.state.gesture) return;
		let n = [...e.nodes].join(" ");
		if (n === this.seen) return;
		this.seen = n;
		let r = this.svg.current.getBoundingClientRect(), i = t.view.nodes.filter((t) => e.nodes.has(t.name)), { x: a, y: o, k: s } = this.state.sight;
		if (i.some((e) => {
			let [t, n] = B(e.x, e.y), [i, c] = [a + s * t, o + s * n];
			return i < 40 || c < 40 || i > r.width - 40 || c > r.height - 40;
		}) && i.length) {
			if (!this.touched) this.fit();
			else {
				let [e, t] = B(i[0].x, i[0].y);
				this.setState({ sight: {
					k: s,
					x: r.width / 2 - s * e,
					y: r.height / 2 - s * t
				} });
			}
		}
	}
	fitOnce() {
		let e = this.props.state.look;
		if (!e) return;
		let t = `${e.file}:${e.view.path}`;
		this.fitted !== t && e.view.nodes.length && (this.fitted = t, this.touched = !1, this.fit());
	}
	fit = () => {
		let e = this.props.state.look?.view.nodes ?? [], t = this.svg.current;
		if (!t) return;
		let n = t.getBoundingClientRect();
		if (!e.length || !n.width) {
			this.setState({ sight: {
				x: n.width / 2,
				y: n.height / 2,
				k: 1
			} });
			return;
		}
		let r = e.map((e) => e.x * z[0]), i = e.map((e) => e.y * z[1]), [a, o] = [Math.min(...r) - 90, Math.max(...r) + 90], [s, c] = [Math.min(...i) - 60, Math.max(...i) + 70], l = Math.min(1.5, n.width / (o - a), n.height / (c - s));
		this.setState({ sight: {
			k: l,
			x: n.width / 2 - l * (a + o) / 2,
			y: n.height / 2 - l * (s + c) / 2
		} });
	};
	zoom(e, t) {
		this.touched = !0;
		let n = this.svg.current.getBoundingClientRect(), [r, i] = t ?? [n.width / 2, n.height / 2], { x: a, y: o, k: s } = this.state.sight, c = Math.max(.05, Math.min(6, s * e));
		this.setState({ sight: {
			k: c,
			x: r - (r - a) * c / s,
			y: i - (i - o) * c / s
		} });
	}
	wheel = (e) => {
		e.preventDefault();
		let t = this.svg.current.getBoundingClientRect();
		if (e.shiftKey && !e.ctrlKey) {
			let t = this.state.sight;
			this.setState({ sight: {
				...t,
				x: t.x - e.deltaY,
				y: t.y - e.deltaX
			} });
		} else this.zoom(Math.exp(-e.deltaY * .0015), [e.clientX - t.left, e.clientY - t.top]);
	};
	local(e) {
		let t = this.svg.current.getBoundingClientRect();
		return [e.clientX - t.left, e.clientY - t.top];
	}
	inGraph([e, t]) {
		let { x: n, y: r, k: i } = this.state.sight;
		return [(e - n) / i, (t - r) / i];
	}
	under(e, t = "") {
		for (let n of document.elementsFromPoint(e.clientX, e.clientY)) {
			let e = n.closest?.("[data-port]")?.getAttribute("data-port");
			if (e && e.split(".")[0] !== t) return e;
			let r = n.closest?.("[data-node]")?.getAttribute("data-node");
			if (r && r !== t) return r;
		}
		return "";
	}
	down = (e) => {
		let { store: t, state: n } = this.props, r = this.local(e);
		if (this.pointers.set(e.pointerId, r), this.svg.current.focus({ preventScroll: !0 }), this.pointers.size === 2) {
			let [[e, t], [n, r]] = [...this.pointers];
			this.setState({
				gesture: {
					kind: "pinch",
					ids: [e, n],
					last: [t, r]
				},
				moved: [0, 0]
			});
			return;
		}
		let i = e.target, a = e.shiftKey || e.ctrlKey || e.metaKey, o = i.closest("[data-handle]")?.getAttribute("data-handle"), s = i.closest("[data-port]")?.getAttribute("data-port"), c = i.closest("[data-node]")?.getAttribute("data-node"), l = i.closest("[data-bond]")?.getAttribute("data-bond"), u = o ?? s ?? (c && (e.altKey || n.drawing) ? c : void 0);
		if (e.button === 1 || e.button === 0 && e.metaKey && !c && !l) this.begin(e, {
			kind: "pan",
			last: r,
			id: e.pointerId,
			moved: !1
		});
		else if (e.button !== 0) return;
		else if (u && n.look?.view.editable) this.begin(e, {
			kind: "wire",
			from: u,
			start: r,
			now: this.inGraph(r),
			target: "",
			id: e.pointerId
		});
		else if (c) {
			if (n.bondFrom && n.bondFrom !== c) {
				t.bond(n.bondFrom, this.under(e) || c);
				return;
			}
			if (!n.nodes.has(c)) t.set({
				nodes: a ? /* @__PURE__ */ new Set([...n.nodes, c]) : /* @__PURE__ */ new Set([c]),
				bonds: a ? n.bonds : /* @__PURE__ */ new Set(),
				tab: n.tab === "problems" || n.tab === "text" ? n.tab : "item"
			});
			else if (a) {
				let e = new Set(n.nodes);
				e.delete(c), t.set({ nodes: e });
				return;
			}
			this.begin(e, {
				kind: "press",
				node: c,
				start: this.inGraph(r),
				at: r,
				id: e.pointerId,
				add: a
			});
		} else if (l) {
			let e = new Set(a ? n.bonds : []);
			a && n.bonds.has(l) ? e.delete(l) : e.add(l), t.set({
				bonds: e,
				nodes: a ? n.nodes : /* @__PURE__ */ new Set(),
				tab: "item"
			});
		} else e.pointerType === "touch" ? this.begin(e, {
			kind: "pan",
			last: r,
			id: e.pointerId,
			moved: !1
		}) : (a || t.set({
			nodes: /* @__PURE__ */ new Set(),
			bonds: /* @__PURE__ */ new Set(),
			bondFrom: null
		}), this.begin(e, {
			kind: "box",
			start: this.inGraph(r),
			now: this.inGraph(r),
			id: e.pointerId,
			add: a
		}));
	};
	begin(e, t) {
		t.kind !== "press" && this.svg.current.setPointerCapture(e.pointerId), this.setState({
			gesture: t,
			moved: [0, 0]
		});
	}
	move = (e) => {
		let { gesture: t, sight: n } = this.state, r = this.local(e);
		if ((t?.kind === "pan" || t?.kind === "pinch") && (this.touched = !0), this.pointers.has(e.pointerId) && this.pointers.set(e.pointerId, r), t) {
			if (t.kind === "pinch") {
				let [e, r] = t.ids.map((e) => this.pointers.get(e)), [i, a] = t.last, o = Math.hypot(i[0] - a[0], i[1] - a[1]), s = Math.hypot(e[0] - r[0], e[1] - r[1]), c = Math.max(.05, Math.min(6, n.k * s / Math.max(o, 1))), [l, u] = [(e[0] + r[0]) / 2, (e[1] + r[1]) / 2], [d, f] = [(i[0] + a[0]) / 2, (i[1] + a[1]) / 2];
				this.setState({
					sight: {
						k: c,
						x: l - (d - n.x) * c / n.k,
						y: u - (f - n.y) * c / n.k
					},
					gesture: {
						...t,
						last: [e, r]
					}
				});
			} else if (t.id === e.pointerId) {
				if (t.kind === "press") {
					if (Math.hypot(r[0] - t.at[0], r[1] - t.at[1]) < 5 || !this.props.state.look?.view.editable) return;
					this.svg.current.setPointerCapture(e.pointerId);
					let n = [...this.props.state.nodes];
					this.setState({ gesture: {
						kind: "drag",
						names: n,
						start: t.start,
						id: t.id
					} });
				} else if (t.kind === "drag") {
					let [e, n] = this.inGraph(r);
					this.setState({ moved: [e - t.start[0], n - t.start[1]] });
				} else if (t.kind === "pan") this.setState({
					sight: {
						...n,
						x: n.x + r[0] - t.last[0],
						y: n.y + r[1] - t.last[1]
					},
					gesture: {
						...t,
						last: r,
						moved: !0
					}
				});
				else if (t.kind === "box") this.setState({ gesture: {
					...t,
					now: this.inGraph(r)
				} });
				else if (t.kind === "wire") {
					let n = this.under(e, t.from.split(".")[0]);
					this.setState({ gesture: {
						...t,
						now: this.inGraph(r),
						target: n
					} });
				}
			}
		}
	};
	up = (e) => {
		let { gesture: t, moved: n } = this.state, { store: r, state: i } = this.props;
		if (this.pointers.delete(e.pointerId), t) {
			if (t.kind === "pinch") this.setState({ gesture: null });
			else if (t.id === e.pointerId) {
				if (t.kind === "press") {
					let e = performance.now(), n = e - this.lastTap.time < 400 && this.lastTap.node === t.node;
					this.lastTap = {
						time: e,
						node: t.node
					}, n ? this.enter(t.node) : !t.add && i.nodes.size > 1 && r.set({ nodes: /* @__PURE__ */ new Set([t.node]) });
				} else if (t.kind === "drag") {
					let a = e.altKey ? .05 : .25, o = {};
					for (let e of i.look.view.nodes) if (t.names.includes(e.name)) {
						let t = e.x + n[0] / z[0], r = e.y + n[1] / z[1];
						o[e.name] = [Math.round(t / a) * a, Math.round(r / a) * a];
					}
					this.place(o), r.edit({
						do: "move",
						at: o
					});
				} else if (t.kind === "box") {
					let [e, n] = [t.start[0], t.now[0]].sort((e, t) => e - t), [a, o] = [t.start[1], t.now[1]].sort((e, t) => e - t), s = i.look.view.nodes.filter((t) => {
						let [r, i] = B(t.x, t.y);
						return r >= e && r <= n && i >= a && i <= o;
					}).map((e) => e.name);
					s.length && r.set({ nodes: new Set(t.add ? [...i.nodes, ...s] : s) });
				} else if (t.kind === "wire") {
					let n = this.under(e, t.from.split(".")[0]) || t.target;
					n ? r.bond(t.from, n) : Math.hypot(...Ge(this.local(e), t.start)) < 8 && r.set({ bondFrom: t.from });
				} else t.kind === "pan" && !t.moved && r.set({
					nodes: /* @__PURE__ */ new Set(),
					bonds: /* @__PURE__ */ new Set(),
					bondFrom: null
				});
				this.setState({
					gesture: null,
					moved: [0, 0]
				});
			}
		}
	};
	place(e) {
		let { store: t, state: n } = this.props, r = n.look, i = r.view.nodes.map((t) => e[t.name] ? {
			...t,
			x: e[t.name][0],
			y: e[t.name][1]
		} : t);
		t.set({ look: {
			...r,
			view: {
				...r.view,
				nodes: i
			}
		} });
	}
	centreOf(e, t, n, r) {
		let i = e.split(".")[0];
		return Ee(t.get(i), e, !1, n.get(i), r.get(i))[0];
	}
	enter(e) {
		let { store: t, state: n } = this.props, r = n.look?.view.nodes.find((t) => t.name === e);
		r?.kind === "part" && r.known ? t.open(n.level ? `${n.level}.${e}` : e) : (t.set({ tab: "item" }), requestAnimationFrame(() => document.querySelector(".side [data-first]")?.focus()));
	}
	key = (e) => {
		let { store: t, state: n } = this.props, r = n.look?.view.nodes ?? [], i = e.ctrlKey || e.metaKey, a = n.nodes.size === 1 ? r.find((e) => n.nodes.has(e.name)) : void 0, o = Ke[e.key];
		if (o && e.altKey && n.nodes.size) {
			let i = e.shiftKey ? .25 : 1, a = {};
			for (let e of r) n.nodes.has(e.name) && (a[e.name] = [e.x + i * o[0], e.y + i * o[1]]);
			this.place(a), t.edit({
				do: "move",
				at: a
			});
		} else if (o && !i) {
			let e = a ?? r[0];
			if (!e) return;
			let n = a ? qe(r, a, o) : e;
			n && t.set({
				nodes: /* @__PURE__ */ new Set([n.name]),
				bonds: /* @__PURE__ */ new Set(),
				tab: "item"
			});
		} else if (e.key === "Tab" && !i) return;
		else if ((e.key === "[" || e.key === "]") && n.look) {
			let r = n.look.view.bonds.filter((e) => !a || e.tail === a.name || e.head === a.name), i = r.length ? r : n.look.view.bonds, o = i[(i.findIndex((e) => n.bonds.has(e.key)) + (e.key === "]" ? 1 : -1) + i.length) % i.length];
			o && t.set({
				bonds: /* @__PURE__ */ new Set([o.key]),
				tab: "item"
			});
		} else if (e.key === "Escape") t.set({
			nodes: /* @__PURE__ */ new Set(),
			bonds: /* @__PURE__ */ new Set(),
			bondFrom: null,
			cursor: null,
			instant: null,
			adding: !1
		});
		else if (e.key === "Enter" && n.bondFrom && a && a.name !== n.bondFrom) t.bond(n.bondFrom, a.name);
		else if (e.key === "Enter" && a) this.enter(a.name);
		else if (e.key === "b" && !i && a) t.set({ bondFrom: a.name });
		else if (e.key === "r" && !i && n.bonds.size) t.reverse();
		else if (e.key === "a" && !i) t.set({ adding: !0 });
		else if (e.key === "f" && !i) this.fit();
		else if (e.key === "+" || e.key === "=") this.zoom(1.25);
		else if (e.key === "-") this.zoom(.8);
		else if (e.key === "a" && i) t.set({ nodes: new Set(r.map((e) => e.name)) });
		else if (e.key === "d" && i) t.duplicate();
		else if (e.key === "Delete" || e.key === "Backspace") t.remove();
		else if (e.key === "PageUp" && n.level) t.open(n.level.split(".").slice(0, -1).join("."));
		else return;
		e.preventDefault();
	};
	dropped = (e) => {
		let t = e.dataTransfer?.getData("application/x-hybond");
		if (!t) return;
		e.preventDefault();
		let { element: n, stem: r } = JSON.parse(t), [i, a] = this.inGraph(this.local(e));
		this.props.store.add(n, r, [Math.round(i / z[0] * 4) / 4, Math.round(a / z[1] * 4) / 4]);
	};
	render({ state: e, store: t }, { sight: n, gesture: r, moved: i }) {
		let a = e.look;
		if (!a) return /* @__PURE__ */ R("div", { class: "canvas" });
		let o = e.cursor?.strokes ?? a.strokes, s = r?.kind === "drag" ? new Set(r.names) : null, c = /* @__PURE__ */ new Map(), l = /* @__PURE__ */ new Map();
		for (let e of a.view.nodes) {
			let [t, n] = B(e.x, e.y);
			c.set(e.name, s?.has(e.name) ? [t + i[0], n + i[1]] : [t, n]), l.set(e.name, e);
		}
		let u = (e) => o.nodes[e.name]?.controlled ?? (!!e.machine || !!e.law), d = /* @__PURE__ */ new Map(), f = /* @__PURE__ */ new Map();
		for (let e of a.view.bonds) {
			d.has(e.tail) || d.set(e.tail, []), d.has(e.head) || d.set(e.head, []), d.get(e.tail).push(c.get(e.head)), d.get(e.head).push(c.get(e.tail));
			let t = [...e.ends].sort().join("|");
			f.set(t, [...f.get(t) ?? [], e.key]);
		}
		let p = /* @__PURE__ */ new Map();
		for (let e of a.view.bonds) for (let [t, n, r] of [[
			e.ends[0],
			e.tail,
			e.head
		], [
			e.ends[1],
			e.head,
			e.tail
		]]) {
			let [e, i] = p.get(t) ?? [0, 0], [a, o] = [c.get(n), c.get(r)];
			p.set(t, [e + o[0] - a[0], i + o[1] - a[1]]);
		}
		let m = /* @__PURE__ */ new Map();
		for (let e of a.view.nodes) e.kind === "part" && m.set(e.name, Se(e, p));
		let h = (e) => m.get(e) ?? "", g = e.cursor?.values, _ = g ? Math.max(1e-300, ...Object.values(g).map((e) => Math.abs((e.e ?? 0) * (e.f ?? 0)))) : 1, v = r?.kind === "wire" ? r.target.split(".")[0] : "";
		return /* @__PURE__ */ R("div", {
			class: "canvas",
			onDragOver: (e) => e.preventDefault(),
			onDrop: this.dropped,
			children: [
				/* @__PURE__ */ R("svg", {
					ref: this.svg,
					tabindex: 0,
					role: "application",
					"aria-label": `Bond graph ${a.title || a.file}: ${a.view.nodes.length} elements, ${a.view.bonds.length} bonds. Arrow keys select, a adds, b bonds, Delete removes.`,
					"aria-describedby": "chosen",
					onPointerDown: this.down,
					onPointerMove: this.move,
					onPointerUp: this.up,
					onPointerCancel: this.up,
					onKeyDown: this.key,
					class: e.flowing ? "flowing" : "",
					children: [
						/* @__PURE__ */ R("defs", { children: [/* @__PURE__ */ R("pattern", {
							id: "dots",
							width: z[0] / 4,
							height: z[1] / 4,
							patternUnits: "userSpaceOnUse",
							patternTransform: `translate(${n.x},${n.y}) scale(${n.k})`,
							children: /* @__PURE__ */ R("circle", {
								cx: 0,
								cy: 0,
								r: .7,
								class: "dot"
							})
						}), /* @__PURE__ */ R("marker", {
							id: "signal",
							viewBox: "0 0 8 8",
							refX: 7,
							refY: 4,
							markerWidth: 7,
							markerHeight: 7,
							orient: "auto",
							children: /* @__PURE__ */ R("path", {
								d: "M0,1L8,4L0,7z",
								class: "signalhead"
							})
						})] }),
						n.k > .45 && /* @__PURE__ */ R("rect", {
							class: "paper",
							width: "100%",
							height: "100%",
							fill: "url(#dots)"
						}),
						/* @__PURE__ */ R("g", {
							transform: `translate(${n.x},${n.y}) scale(${n.k})`,
							children: [
								a.view.modulations.map((e) => {
									let t = l.get(e.from), n = l.get(e.to);
									if (!t || !n) return null;
									let [r, i] = [c.get(e.from), c.get(e.to)], a = de(Te(t, u(t), r, h(t.name)), Te(n, u(n), i, h(n.name)), r, i, 7);
									return /* @__PURE__ */ R("line", {
										class: "signal",
										x1: a.tail[0],
										y1: a.tail[1],
										x2: a.head[0],
										y2: a.head[1],
										"marker-end": "url(#signal)"
									});
								}),
								/* @__PURE__ */ R("g", { children: a.view.bonds.map((t) => {
									let [r, i] = [l.get(t.tail), l.get(t.head)], [a, s] = [c.get(t.tail), c.get(t.head)], d = f.get([...t.ends].sort().join("|")), p = g?.[t.key];
									return /* @__PURE__ */ R(Ae, {
										bond: t,
										tail: r,
										head: i,
										tx: a[0],
										ty: a[1],
										hx: s[0],
										hy: s[1],
										tailControlled: u(r),
										headControlled: u(i),
										tailPorts: h(t.tail),
										headPorts: h(t.head),
										shift: d.indexOf(t.key) - (d.length - 1) / 2,
										drawn: o.bonds[t.key] ?? o.bonds[`${t.ends[0]} -> ${t.ends[1]}`],
										selected: e.bonds.has(t.key),
										effort: p && n.k > .6 ? Ve(p.e, p.units[0]) : "",
										rate: p && n.k > .6 ? Ve(p.f, p.units[1]) : "",
										flow: e.flowing && p ? (p.e ?? 0) * (p.f ?? 0) / _ : 0
									}, t.key);
								}) }),
								/* @__PURE__ */ R("g", { children: a.view.nodes.map((t) => /* @__PURE__ */ R(Ne, {
									node: t,
									x: c.get(t.name)[0],
									y: c.get(t.name)[1],
									state: o.nodes[t.name],
									selected: e.nodes.has(t.name),
									ports: h(t.name),
									target: v === t.name || e.bondFrom === t.name,
									taken: [...ve(c.get(t.name), d.get(t.name) ?? [])].sort().join("")
								}, t.name)) }),
								r?.kind === "wire" && /* @__PURE__ */ R(Ue, {
									from: this.centreOf(r.from, l, c, m),
									to: r.now
								}),
								r?.kind === "box" && /* @__PURE__ */ R("rect", {
									class: "marquee",
									x: Math.min(r.start[0], r.now[0]),
									y: Math.min(r.start[1], r.now[1]),
									width: Math.abs(r.now[0] - r.start[0]),
									height: Math.abs(r.now[1] - r.start[1])
								})
							]
						})
					]
				}),
				r?.kind === "wire" && /* @__PURE__ */ R("div", {
					class: "wiretext",
					role: "status",
					children: [
						r.from,
						" ",
						"->",
						" ",
						r.target || "…"
					]
				}),
				e.instant && /* @__PURE__ */ R(We, {
					store: t,
					state: e
				}),
				e.bondFrom && /* @__PURE__ */ R("div", {
					class: "wiretext",
					role: "status",
					children: [
						e.bondFrom,
						" ",
						"->",
						" ",
						[...e.nodes].find((t) => t !== e.bondFrom) ?? "…",
						": choose the other end"
					]
				}),
				/* @__PURE__ */ R("div", {
					class: "views",
					children: [
						/* @__PURE__ */ R("button", {
							title: "Zoom in (+)",
							"aria-label": "Zoom in",
							onClick: () => this.zoom(1.25),
							children: "+"
						}),
						/* @__PURE__ */ R("button", {
							title: "Zoom out (-)",
							"aria-label": "Zoom out",
							onClick: () => this.zoom(.8),
							children: "−"
						}),
						/* @__PURE__ */ R("button", {
							title: "Show all (f)",
							"aria-label": "Show all",
							onClick: this.fit,
							children: "⤢"
						})
					]
				}),
				/* @__PURE__ */ R(Je, {
					state: e,
					sight: n
				}),
				a.view.crumbs.length > 0 && /* @__PURE__ */ R("nav", {
					class: "crumbs",
					"aria-label": "Submodel",
					children: [
						/* @__PURE__ */ R("button", {
							onClick: () => t.open(""),
							children: a.title || a.file
						}),
						a.view.crumbs.map((e, n) => /* @__PURE__ */ R(x, { children: [" › ", /* @__PURE__ */ R("button", {
							onClick: () => t.open(a.view.crumbs.slice(0, n + 1).join(".")),
							children: e
						})] })),
						!a.view.editable && /* @__PURE__ */ R("span", { children: [
							" (",
							a.view.name,
							", a ready part: to look at)"
						] })
					]
				})
			]
		});
	}
};
function Ue({ from: e, to: t }) {
	return /* @__PURE__ */ R("line", {
		class: "wire",
		x1: e[0],
		y1: e[1],
		x2: t[0],
		y2: t[1]
	});
}
function We({ store: e, state: t }) {
	let { event: n, step: r } = t.instant, i = n.steps[r], a = r < n.steps.length - 1 ? "values before" : "values after";
	return /* @__PURE__ */ R("div", {
		class: "wiretext instant " + i.kind,
		role: "status",
		children: [
			/* @__PURE__ */ R("button", {
				"aria-label": "Mode before",
				disabled: r === 0,
				onClick: () => e.showInstant(n, r - 1),
				children: "◂"
			}),
			"t = ",
			Ve(n.t, "s"),
			", mode ",
			r + 1,
			" of ",
			n.steps.length,
			": ",
			/* @__PURE__ */ R("b", { children: i.kind }),
			" ",
			/* @__PURE__ */ R("small", { children: [
				"(",
				a,
				")"
			] }),
			/* @__PURE__ */ R("button", {
				"aria-label": "Mode after",
				disabled: r + 1 === n.steps.length,
				onClick: () => e.showInstant(n, r + 1),
				children: "▸"
			})
		]
	});
}
var Ge = (e, t) => [e[0] - t[0], e[1] - t[1]], Ke = {
	ArrowLeft: [-1, 0],
	ArrowRight: [1, 0],
	ArrowUp: [0, -1],
	ArrowDown: [0, 1]
};
function qe(e, t, [n, r]) {
	let i, a = Infinity;
	for (let o of e) {
		let e = (o.x - t.x) * n + (o.y - t.y) * r, s = Math.abs((o.x - t.x) * r - (o.y - t.y) * n);
		if (e <= .01) continue;
		let c = e + 2.5 * s;
		c < a && ([i, a] = [o, c]);
	}
	return i;
}
function Je({ state: e, sight: t }) {
	let n = e.look.view.nodes;
	if (n.length < 25) return null;
	let r = n.map((e) => e.x), i = n.map((e) => e.y), [a, o] = [Math.min(...r) - 1, Math.min(...i) - 1], [s, c] = [Math.max(...r) + 2 - a, Math.max(...i) + 2 - o], l = {
		x: -t.x / t.k / z[0],
		y: -t.y / t.k / z[1]
	};
	return /* @__PURE__ */ R("svg", {
		class: "minimap",
		viewBox: `${a} ${o} ${s} ${c}`,
		"aria-hidden": "true",
		children: [n.map((e) => /* @__PURE__ */ R("circle", {
			cx: e.x,
			cy: e.y,
			r: s / 90
		})), /* @__PURE__ */ R("rect", {
			x: l.x,
			y: l.y,
			width: 900 / t.k / z[0],
			height: 500 / t.k / z[1]
		})]
	});
}
// node_modules/preact/hooks/dist/hooks.mjs
var Ye, V, Xe, Ze, Qe = Object.is, $e = 0, et = [], tt = [], H = e, nt = H.__b, rt = H.__r, it = H.diffed, at = H.__c, ot = H.unmount, st = H.__;
function ct(e, t) {
	H.__h && H.__h(V, e, $e || t), $e = 0;
	var n = V.__H || (V.__H = {
		__: [],
		__h: []
	});
	return e >= n.__.length && n.__.push({}), n.__[e];
}
function lt(e) {
	return $e = 1, ut(xt, e);
}
function ut(e, t, n) {
	var r = ct(Ye++, 2);
	if (r.t = e, !r.__c && (r.__ = [n ? n(t) : xt(void 0, t), function(e) {
		var t = (r.__N || r.__)[0], n = r.t(t, e);
		Qe(t, n) || (r.__N = [n, r.__[1]], r.__c.setState({}));
	}], r.__c = V, !V.__f)) {
		V.__f = !0;
		var i = V.shouldComponentUpdate;
		V.shouldComponentUpdate = function(e, t, n) {
			var r = this.__H;
			if (!r) return !0;
			var a = !1, o = this.props != e;
			if (r.__.some(function(e) {
				e.__N && (a = !0, Qe(e.__[0], e.__N[0]) || (o = !0));
			}), i) {
				var s = i.call(this, e, t, n);
				return a ? s || o : s;
			}
			return !a || o;
		};
	}
	return r.__;
}
function dt(e, t) {
	var n = ct(Ye++, 3);
	!H.__s && bt(n.__H, t) && (n.__P = !0, n.__ = e, n.u = t, V.__H.__h.push(n));
}
function ft(e) {
	return $e = 5, pt(function() {
		return { current: e };
	}, []);
}
function pt(e, t) {
	var n = ct(Ye++, 7);
	return bt(n.__H, t) && (n.__ = e(), n.__H = t), n.__;
}
function mt() {
	var e;
	do {
		for (; e = tt.shift();) try {
			vt(e);
		} catch (t) {
			H.__e(t, { __: (e = e.__P) && e.__v });
		}
		for (; e = et.shift();) {
			var t = e.__H;
			if (e.__P && t) try {
				t.__h.some(vt), t.__h.some(yt), t.__h = [];
			} catch (n) {
				t.__h = [], H.__e(n, e.__v);
			}
		}
	} while (tt.length);
}
H.__b = function(e) {
	V = null, nt && nt(e);
}, H.__ = function(e, t) {
	e && t.__k && t.__k.__m && (e.__m = t.__k.__m), st && st(e, t);
}, H.__r = function(e) {
	rt && rt(e), Ye = 0;
	var t = (V = e.__c).__H;
	t && (Xe == V ? V.__h = [] : (t.__h.some(vt), t.__h.some(yt), Ye = 0), t.__h = [], t.__.some(function(e) {
		e.__N && (e.__ = e.__N), e.u = e.__N = void 0;
	})), Xe = V;
}, H.diffed = function(e) {
	it && it(e);
	var t = e.__c;
	t && t.__H && (t.__H.__h.length && _t(et.push(t)), t.__H.__.some(function(e) {
		e.u && (e.__H = e.u);
	})), Xe = V = null;
}, H.__c = function(e, t) {
	t.some(function(e) {
		try {
			e.__h.some(vt), e.__h = e.__h.filter(function(e) {
				return !e.__ || yt(e);
			});
		} catch (t) {
			e.__h = [function() {
				throw t;
			}];
		}
	}), at && at(e, t);
}, H.unmount = function(e) {
	ot && ot(e);
	var t, n, r = e.__c;
	r && r.__H && (r.__H.__.some(function(r) {
		try {
			if (r.__P && r.__c) {
				if (n === void 0) {
					for (n = e.__; n && (!n.__c || !n.__c.__P);) n = n.__;
					n &&= n.__c;
				}
				r.__P = n, _t(tt.push(r));
			} else vt(r);
		} catch (e) {
			t = e;
		}
	}), r.__H = void 0, t && H.__e(t, r.__v));
};
var ht = typeof requestAnimationFrame == "function";
function gt(e) {
	var t, n = function() {
		clearTimeout(r), ht && cancelAnimationFrame(t), setTimeout(e);
	}, r = setTimeout(n, 35);
	ht && (t = requestAnimationFrame(n));
}
function _t(e) {
	e != 1 && Ze == H.requestAnimationFrame || ((Ze = H.requestAnimationFrame) || gt)(mt);
}
function vt(e) {
	var t = V, n = e.__c;
	typeof n == "function" && (e.__c = void 0, n()), V = t;
}
function yt(e) {
	var t = V;
	e.__c = e.__(), V = t;
}
function bt(e, t) {
	return !e || e.length != t.length || t.some(function(t, n) {
		return !Qe(t, e[n]);
	});
}
function xt(e, t) {
	return typeof t == "function" ? t(e) : t;
}
// src/events.tsx
var St = 100;
function Ct({ store: e, state: t }) {
	let [n, r] = lt([]), [i, a] = lt(0), [o, s] = lt(0), c = t.run;
	dt(() => s(0), [c?.run]), dt(() => {
		if (!c || c.tEnd === void 0) return r([]);
		let t = !1;
		return e.transport.ask("events", {
			run: c.run,
			first: o,
			count: St
		}).then((e) => {
			t || (r(e.events), a(e.total));
		}).catch((t) => e.refused(t)), () => {
			t = !0;
		};
	}, [c?.run, o]);
	let l = t.instant?.event.event;
	return /* @__PURE__ */ R("section", {
		class: "events",
		tabindex: 0,
		"aria-label": "Events",
		children: [
			c && c.tEnd !== void 0 && /* @__PURE__ */ R("p", {
				class: "status " + c.status,
				children: [
					c.status === "ok" ? "ok" : /* @__PURE__ */ R("b", { children: c.status }),
					", ",
					i,
					" events, ",
					Ve(c.took, "s"),
					c.method ? `, ${c.method}` : ""
				]
			}),
			c?.warnings?.map((e) => /* @__PURE__ */ R("p", {
				class: "warning",
				children: e
			})),
			i > St && /* @__PURE__ */ R("p", { children: [
				/* @__PURE__ */ R("button", {
					disabled: o === 0,
					onClick: () => s(Math.max(0, o - St)),
					children: "◂"
				}),
				" ",
				o + 1,
				" to ",
				Math.min(o + St, i),
				" of ",
				i,
				" ",
				/* @__PURE__ */ R("button", {
					disabled: o + St >= i,
					onClick: () => s(o + St),
					children: "▸"
				})
			] }),
			/* @__PURE__ */ R("ol", { children: n.map((n) => /* @__PURE__ */ R("li", {
				class: n.event === l ? "open" : "",
				children: [/* @__PURE__ */ R("button", {
					"data-event": n.event,
					"aria-expanded": n.event === l,
					onClick: () => e.showInstant(n, 0),
					children: [
						/* @__PURE__ */ R("b", { children: Ve(n.t, "s") }),
						" ",
						/* @__PURE__ */ R("i", { children: n.cause }),
						" ",
						n.steps.flatMap((e) => e.fired).map((e) => `${e.machine}: ${e.source} → ${e.target}`).join("; "),
						n.steps.some((e) => e.kind !== "continuous") && /* @__PURE__ */ R("em", { children: [" ", wt(n)] })
					]
				}), n.event === l && /* @__PURE__ */ R(Tt, {
					store: e,
					state: t,
					event: n
				})]
			})) })
		]
	});
}
function wt(e) {
	let t = (t) => e.steps.filter((e) => e.kind === t).length;
	return [[t("mythical"), "mythical"], [t("pinnacle"), "pinnacle"]].filter(([e]) => e).map(([e, t]) => e === 1 ? t : `${e} ${t}`).join(", ");
}
function Tt({ store: e, state: t, event: n }) {
	let r = t.instant.step, i = n.steps[r];
	return /* @__PURE__ */ R("div", {
		class: "detail",
		children: [
			/* @__PURE__ */ R("div", {
				class: "row",
				children: n.steps.map((t, i) => /* @__PURE__ */ R("button", {
					class: "stepbutton " + t.kind,
					"aria-pressed": i === r,
					"data-step": i,
					onClick: () => e.showInstant(n, i),
					children: [
						i + 1,
						". ",
						t.kind
					]
				}))
			}),
			/* @__PURE__ */ R("p", { children: [
				"mode: ",
				Object.entries(i.mode).map(([e, t]) => `${e} = ${t}`).join(", ") || "the only one",
				i.kind === "mythical" && " (lasts no time, stores nothing)",
				i.kind === "pinnacle" && " (lasts no time, writes the state)"
			] }),
			i.fired.map((e) => /* @__PURE__ */ R("p", {
				class: "fired",
				children: [
					/* @__PURE__ */ R("b", { children: e.machine }),
					": ",
					e.source,
					" → ",
					e.target,
					", because ",
					/* @__PURE__ */ R("code", { children: e.why })
				]
			})),
			Object.keys(i.impulses).length > 0 && /* @__PURE__ */ R("p", { children: [
				"impulses",
				i.kind === "mythical" ? " (on trial)" : "",
				":",
				" ",
				Object.entries(i.impulses).map(([e, t]) => `${e} = ${ze(t, 6)} δ`).join(", ")
			] }),
			i.energy && /* @__PURE__ */ R("p", { children: [
				"energy ",
				i.energy.before,
				" → ",
				i.energy.after,
				"; supplied ",
				i.energy.source,
				", lost ",
				i.energy.lost
			] }),
			i.undetermined.length > 0 && /* @__PURE__ */ R("p", { children: ["not determined: ", i.undetermined.join(", ")] })
		]
	});
}
// src/formulas.tsx
var Et = new Set("math mrow mi mo mn mtext mspace mfrac msub msup msubsup mover munder munderover msqrt mroot mtable mtr mtd mstyle".split(" "));
function Dt(e) {
	if (typeof e == "string") return e;
	let [t, n, ...r] = e, i = t === "math" ? { display: "block" } : {};
	return v(Et.has(t) ? t : "mrow", {
		...n,
		...i
	}, ...r.map(Dt));
}
function Ot({ store: e, state: t }) {
	let [n, r] = lt("all"), [i, a] = lt(!1), [o, s] = lt(null), c = t.look, l = t.cursor?.mode ?? Object.fromEntries(c.machines.map((e) => [e.path, e.state])), u = n === "mode" ? JSON.stringify(l) : "";
	return dt(() => {
		let t = !1;
		return s(null), e.transport.ask(n === "structure" ? "structure" : "equations", {
			one: n === "mode",
			mode: l
		}).then((e) => !t && s(e)).catch((e) => !t && s({ text: String(e.message) })), () => {
			t = !0;
		};
	}, [
		c.revision,
		n,
		u
	]), /* @__PURE__ */ R("section", {
		class: "formulas",
		children: [
			/* @__PURE__ */ R("div", {
				class: "row",
				children: [[
					["all", "all modes"],
					["mode", "the mode drawn"],
					["structure", "structure"]
				].map(([e, t]) => /* @__PURE__ */ R("button", {
					"aria-pressed": n === e,
					onClick: () => r(e),
					children: t
				})), o?.formula && /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("input", {
					type: "checkbox",
					checked: i,
					onChange: (e) => a(e.currentTarget.checked)
				}), " as text"] })]
			}),
			!o && /* @__PURE__ */ R("p", {
				class: "hint",
				children: "…"
			}),
			o?.formula && !i ? /* @__PURE__ */ R("div", {
				class: "formula",
				tabindex: 0,
				role: "group",
				"aria-label": "Equations",
				children: Dt(o.formula)
			}) : o && /* @__PURE__ */ R("pre", {
				class: "equations",
				tabindex: 0,
				children: o.text
			}),
			o?.notes?.map((e) => /* @__PURE__ */ R("p", {
				class: "hint",
				children: e
			}))
		]
	});
}
// src/fields.tsx
var kt = 0;
function At(e) {
	let [t, n] = lt(e.value), [r] = lt(() => `list${++kt}`), i = ft(!1);
	return dt(() => {
		i.current || n(e.value);
	}, [e.value]), /* @__PURE__ */ R(x, { children: [/* @__PURE__ */ R("input", {
		"aria-label": e.label,
		value: t,
		disabled: e.disabled,
		placeholder: e.placeholder,
		spellcheck: !1,
		autocomplete: "off",
		list: e.list ? r : void 0,
		"data-first": e.first ? "" : void 0,
		onFocus: () => i.current = !0,
		onInput: (e) => n(e.currentTarget.value),
		onBlur: () => {
			i.current = !1, t !== e.value && e.onWrite(t);
		},
		onKeyDown: (t) => {
			t.key === "Enter" && t.currentTarget.blur(), t.key === "Escape" && (n(e.value), i.current = !1, requestAnimationFrame(() => document.querySelector(".canvas svg")?.focus())), t.stopPropagation();
		}
	}), e.list && /* @__PURE__ */ R("datalist", {
		id: r,
		children: e.list.map((e) => /* @__PURE__ */ R("option", { value: e }))
	})] });
}
function jt(e) {
	let t = e.trim();
	return t === "" ? null : /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(t) ? Number(t) : t;
}
// src/item.tsx
var Mt = {
	C: ["q", "e"],
	I: ["p", "f"]
}, Nt = {
	diode: [],
	thyristor: ["gate"],
	unilateral: [
		"gap",
		"restitution",
		"stiffness"
	],
	coulomb: ["limit", "breakaway"],
	relay: ["limit"]
};
function Pt({ store: e, state: t }) {
	let n = t.look, r = n.view.nodes.filter((e) => t.nodes.has(e.name)), i = n.view.bonds.filter((e) => t.bonds.has(e.key));
	if (r.length === 1) return /* @__PURE__ */ R(Rt, {
		store: e,
		state: t,
		node: r[0]
	});
	if (i.length === 1 && !r.length) {
		let r = i[0], a = t.cursor?.values[r.key];
		return /* @__PURE__ */ R("section", { children: [
			/* @__PURE__ */ R("h2", { children: "Bond" }),
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "written" }), /* @__PURE__ */ R(At, {
				label: "Bond",
				first: !0,
				value: r.text,
				disabled: !n.view.editable,
				onWrite: (n) => void Ft(e, t, r.key, n)
			})] }),
			a && /* @__PURE__ */ R("p", { children: [
				"effort ",
				Ve(a.e, a.units[0]),
				", flow ",
				Ve(a.f, a.units[1]),
				", power",
				" ",
				a.e === null || a.f === null ? "—" : Ve(a.e * a.f, "W")
			] }),
			/* @__PURE__ */ R("div", {
				class: "row",
				children: [/* @__PURE__ */ R("button", {
					onClick: () => e.reverse(),
					children: "Turn round (r)"
				}), /* @__PURE__ */ R("button", {
					onClick: () => e.remove(),
					children: "Delete"
				})]
			})
		] });
	}
	return r.length + i.length > 1 ? /* @__PURE__ */ R("section", { children: [/* @__PURE__ */ R("h2", { children: [
		r.length,
		" elements, ",
		i.length,
		" bonds"
	] }), /* @__PURE__ */ R("div", {
		class: "row",
		children: [
			/* @__PURE__ */ R("button", {
				onClick: () => It(e, r, "y"),
				children: "In a row"
			}),
			/* @__PURE__ */ R("button", {
				onClick: () => It(e, r, "x"),
				children: "In a column"
			}),
			/* @__PURE__ */ R("button", {
				onClick: () => void e.duplicate(),
				children: "Duplicate"
			}),
			/* @__PURE__ */ R("button", {
				onClick: () => e.remove(),
				children: "Delete"
			})
		]
	})] }) : /* @__PURE__ */ R(Lt, {
		store: e,
		state: t
	});
}
async function Ft(e, t, n, r) {
	let [i] = n.split(".").map(Number);
	t.look.view.bonds.filter((e) => e.key.startsWith(`${i}.`)).length === 1 ? await e.edit({
		do: "write bond",
		chain: i,
		text: r
	}) : (await e.edit({
		do: "remove",
		names: [],
		bonds: [n]
	}), r.trim() && await e.edit({
		do: "write bond",
		text: r
	}));
}
function It(e, t, n) {
	let r = t.reduce((e, t) => e + t[n], 0) / t.length, i = Math.round(r * 4) / 4, a = Object.fromEntries(t.map((e) => [e.name, n === "y" ? [e.x, i] : [i, e.y]]));
	e.edit({
		do: "move",
		at: a
	});
}
function Lt({ store: e, state: t }) {
	let n = t.look, r = t.stock?.domains ?? [], i = (t, n) => void e.edit({
		do: "set",
		path: t,
		value: n
	});
	return /* @__PURE__ */ R("section", { children: [
		/* @__PURE__ */ R("h2", { children: "Model" }),
		/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "title" }), /* @__PURE__ */ R(At, {
			label: "Title",
			first: !0,
			value: n.title,
			disabled: !n.view.editable,
			onWrite: (e) => i(["title"], e)
		})] }),
		/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "domain" }), /* @__PURE__ */ R("select", {
			disabled: !n.view.editable,
			value: n.view.domain,
			onChange: (e) => i(["domain"], e.currentTarget.value),
			children: r.map((e) => /* @__PURE__ */ R("option", {
				value: e.name,
				children: [
					e.name,
					" ",
					e.effort && `(${e.effort}, ${e.flow})`
				]
			}))
		})] }),
		/* @__PURE__ */ R("p", {
			class: "hint",
			children: [
				"Put elements down from the palette, or press ",
				/* @__PURE__ */ R("kbd", { children: "a" }),
				" and write ",
				/* @__PURE__ */ R("code", { children: "R load 10 ohm" }),
				". Drag from the handle of a selected element to bond it, or press ",
				/* @__PURE__ */ R("kbd", { children: "b" }),
				". Strokes follow each edit."
			]
		})
	] });
}
function Rt({ store: e, state: t, node: n }) {
	let r = !t.look.view.editable, i = n.entry, a = (t, r) => void e.edit({
		do: "set",
		path: [
			"elements",
			n.name,
			...t
		],
		value: r
	}), o = (t) => void e.edit({
		do: "rename",
		old: n.name,
		new: t.trim()
	}).then((n) => n && e.set({ nodes: /* @__PURE__ */ new Set([t.trim()]) })), s = n.kind === "0" || n.kind === "1", c = t.stock?.parts.find((e) => e.name === i.submodel);
	return /* @__PURE__ */ R("section", { children: [
		/* @__PURE__ */ R("h2", { children: n.kind === "part" ? String(i.submodel) : t.stock?.kinds.find((e) => e.kind === n.kind)?.about ?? n.kind }),
		/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "name" }), /* @__PURE__ */ R(At, {
			label: "Name",
			first: s || n.kind === "part",
			value: n.name,
			disabled: r,
			onWrite: o
		})] }),
		!s && n.kind !== "part" && /* @__PURE__ */ R(zt, {
			node: n,
			off: r,
			set: a
		}),
		Mt[n.kind]?.map((e) => /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: ["start ", e] }), /* @__PURE__ */ R(At, {
			label: `Start value ${e}`,
			value: Ht(i[e]),
			disabled: r,
			placeholder: "0",
			onWrite: (t) => a([e], jt(t))
		})] })),
		s && /* @__PURE__ */ R(x, { children: [
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "kind" }), /* @__PURE__ */ R("select", {
				disabled: r,
				value: n.kind,
				onChange: (e) => a(["junction"], Number(e.currentTarget.value)),
				children: [/* @__PURE__ */ R("option", {
					value: "0",
					children: "0, common effort"
				}), /* @__PURE__ */ R("option", {
					value: "1",
					children: "1, common flow"
				})]
			})] }),
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "law" }), /* @__PURE__ */ R("select", {
				disabled: r,
				value: Ht(i.law),
				onChange: (e) => a(["law"], e.currentTarget.value || null),
				children: [/* @__PURE__ */ R("option", {
					value: "",
					children: "none"
				}), t.stock?.laws.map((e) => /* @__PURE__ */ R("option", {
					value: e,
					children: e
				}))]
			})] }),
			(Nt[Ht(i.law)] ?? []).map((e) => /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: e }), /* @__PURE__ */ R(At, {
				label: e,
				value: Ht(i[e]),
				disabled: r,
				onWrite: (t) => a([e], jt(t))
			})] })),
			/* @__PURE__ */ R(Bt, {
				store: e,
				state: t,
				node: n
			})
		] }),
		n.kind === "part" && /* @__PURE__ */ R(x, { children: [
			c && /* @__PURE__ */ R("p", {
				class: "hint",
				children: c.title
			}),
			Object.entries({
				...c?.parameters,
				...i.parameters
			}).map(([e]) => {
				let t = i.parameters?.[e];
				return /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: e }), /* @__PURE__ */ R(At, {
					label: e,
					value: Ht(t),
					disabled: r,
					placeholder: c?.parameters[e],
					onWrite: (t) => a(["parameters", e], jt(t))
				})] });
			}),
			n.inputs?.map((e) => /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: [e, " ⟵"] }), /* @__PURE__ */ R(At, {
				label: `Input ${e}`,
				value: Ht(i.inputs?.[e]),
				disabled: r,
				placeholder: "an expression",
				list: Ut(t),
				onWrite: (t) => a(["inputs", e], jt(t))
			})] })),
			n.known && /* @__PURE__ */ R("button", {
				onClick: () => e.open(t.level ? `${t.level}.${n.name}` : n.name),
				children: "Open"
			})
		] }),
		/* @__PURE__ */ R("div", {
			class: "row",
			children: [
				/* @__PURE__ */ R("button", {
					disabled: r,
					onClick: () => e.set({ bondFrom: n.name }),
					children: "Bond (b)"
				}),
				/* @__PURE__ */ R("button", {
					disabled: r,
					onClick: () => void e.duplicate(),
					children: "Duplicate"
				}),
				/* @__PURE__ */ R("button", {
					disabled: r,
					onClick: () => e.remove(),
					children: "Delete"
				})
			]
		})
	] });
}
function zt({ node: e, off: t, set: n }) {
	let r = e.entry[e.kind];
	if (typeof r == "object" && r && !Array.isArray(r)) {
		let [i, a] = Object.entries(r)[0] ?? ["e", ""];
		if (typeof a == "string") return /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: [i, " ="] }), /* @__PURE__ */ R(At, {
			label: `Law, ${i} =`,
			first: !0,
			value: a,
			disabled: t,
			onWrite: (t) => n([e.kind, i], t)
		})] });
	}
	return typeof r == "object" && r ? /* @__PURE__ */ R("p", {
		class: "hint",
		children: "A field or a table: edit it in the text."
	}) : /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "value" }), /* @__PURE__ */ R(At, {
		label: "Value",
		first: !0,
		value: Ht(r),
		disabled: t,
		onWrite: (t) => {
			let r = /^\s*([ef])\s*=\s*(.+)$/.exec(t);
			n([e.kind], r ? { [r[1]]: r[2] } : jt(t) ?? 1);
		}
	})] });
}
function Bt({ store: e, state: t, node: n }) {
	let r = t.look;
	return n.machine ? /* @__PURE__ */ R("p", { children: ["switched by ", /* @__PURE__ */ R("button", {
		class: "link",
		onClick: () => e.set({ tab: "machines" }),
		children: n.machine
	})] }) : n.law ? null : /* @__PURE__ */ R("button", {
		disabled: !r.view.editable,
		onClick: () => void e.edit({
			do: "set",
			path: ["machines", Vt(Object.keys(r.panels.machines), `${n.name}_switch`)],
			value: {
				states: {
					on: [n.name],
					off: []
				},
				start: "on",
				rules: []
			}
		}).then(() => e.set({ tab: "machines" })),
		children: "Let a state machine switch it"
	});
}
function Vt(e, t) {
	if (!e.includes(t)) return t;
	for (let n = 2;; n++) if (!e.includes(`${t}${n}`)) return `${t}${n}`;
}
function Ht(e) {
	return e == null ? "" : typeof e == "object" ? JSON.stringify(e) : String(e);
}
function Ut(e) {
	let t = e.look;
	if (!t) return [];
	let n = ["time"];
	for (let e of t.view.nodes) n.push(`${e.name}.e`, `${e.name}.f`), e.kind === "C" && n.push(`${e.name}.q`), e.kind === "I" && n.push(`${e.name}.p`);
	return n.push(...t.view.signals.map((e) => e.name), ...Object.keys(t.panels.parameters)), n;
}
// src/machines.tsx
function Wt(e) {
	let t = /^\s*(\w+)\s*->\s*(\w+)\s+when\s+(.+)$/s.exec(e);
	return t ? {
		source: t[1],
		target: t[2],
		guard: t[3]
	} : null;
}
function Gt({ store: e, state: t }) {
	let n = t.look, r = Object.entries(n.panels.machines);
	return /* @__PURE__ */ R("section", { children: [
		/* @__PURE__ */ R("h2", { children: "State machines" }),
		r.map(([n, r]) => /* @__PURE__ */ R(Kt, {
			store: e,
			state: t,
			name: n,
			machine: r
		}, n)),
		n.view.editable && /* @__PURE__ */ R("button", {
			onClick: () => {
				let i = n.view.nodes.find((e) => t.nodes.has(e.name) && (e.kind === "0" || e.kind === "1")), a = Vt([...r.map(([e]) => e), ...n.view.nodes.map((e) => e.name)], "S");
				e.edit({
					do: "set",
					path: ["machines", a],
					value: {
						states: {
							on: i ? [i.name] : [],
							off: []
						},
						start: "on",
						rules: []
					}
				});
			},
			children: "New machine"
		}),
		/* @__PURE__ */ R("p", {
			class: "hint",
			children: [
				"In guards ",
				/* @__PURE__ */ R("code", { children: "pre(x)" }),
				" is the value before the instant (a priori ",
				/* @__PURE__ */ R("b", { children: "x⁻" }),
				"), ",
				/* @__PURE__ */ R("code", { children: "x" }),
				" the one that holds after it (a posteriori ",
				/* @__PURE__ */ R("b", { children: "x⁺" }),
				")."
			]
		})
	] });
}
function Kt({ store: e, state: t, name: n, machine: r }) {
	let i = t.look, a = !i.view.editable, o = t.level ? `${t.level}.${n}` : n, s = t.cursor?.mode[o] ?? i.machines.find((e) => e.path === o)?.state, c = Object.keys(r.states ?? {}), l = r.rules ?? [], u = (t) => void e.edit({
		do: "set",
		path: ["machines", n],
		value: t
	}), d = (e, t) => u({
		...r,
		rules: t === null ? l.filter((t, n) => n !== e) : l.map((n, r) => r === e ? t : n)
	}), f = i.view.nodes.filter((e) => e.kind !== "part" && e.kind !== "?").map((e) => e.name);
	return /* @__PURE__ */ R("div", {
		class: "machine",
		"data-machine": n,
		children: [
			/* @__PURE__ */ R("div", {
				class: "row",
				children: [/* @__PURE__ */ R(At, {
					label: `Name of machine ${n}`,
					value: n,
					disabled: a,
					onWrite: (t) => void e.edit({
						do: "rename",
						old: n,
						new: t.trim()
					})
				}), !a && /* @__PURE__ */ R("button", {
					class: "small",
					"aria-label": `Delete machine ${n}`,
					onClick: () => void e.edit({
						do: "set",
						path: ["machines", n],
						value: null
					}),
					children: "✕"
				})]
			}),
			/* @__PURE__ */ R(qt, {
				machine: r,
				now: s,
				onState: (t) => e.setMode(o, t)
			}),
			c.map((e) => /* @__PURE__ */ R("div", {
				class: "row state",
				children: [
					/* @__PURE__ */ R("input", {
						type: "radio",
						name: `start-${n}`,
						"aria-label": `${n} starts in ${e}`,
						title: "start state",
						checked: r.start === e,
						disabled: a,
						onChange: () => u({
							...r,
							start: e
						})
					}),
					/* @__PURE__ */ R(At, {
						label: `State ${e} of ${n}`,
						value: e,
						disabled: a,
						onWrite: (t) => {
							let n = t.trim();
							if (!n) {
								let { [e]: t, ...n } = r.states;
								return u({
									...r,
									states: n,
									start: r.start === e ? Object.keys(n)[0] : r.start
								});
							}
							u({
								states: Object.fromEntries(Object.entries(r.states).map(([t, r]) => [t === e ? n : t, r])),
								start: r.start === e ? n : r.start,
								rules: l.map((t) => {
									let r = Wt(t);
									return r ? `${r.source === e ? n : r.source} -> ${r.target === e ? n : r.target} when ${r.guard}` : t;
								})
							});
						}
					}),
					/* @__PURE__ */ R("span", {
						class: "on",
						children: "ON"
					}),
					/* @__PURE__ */ R(At, {
						label: `Junctions that state ${e} of ${n} switches on`,
						value: (r.states[e] ?? []).join(", "),
						disabled: a,
						list: f,
						placeholder: "none",
						onWrite: (t) => u({
							...r,
							states: {
								...r.states,
								[e]: t.split(/[\s,]+/).filter(Boolean)
							}
						})
					})
				]
			})),
			l.map((e, r) => {
				let i = Wt(e), o = i && /\bpre\s*\(/.test(i.guard);
				return /* @__PURE__ */ R("div", {
					class: "row rule",
					children: [i ? /* @__PURE__ */ R(x, { children: [
						/* @__PURE__ */ R("select", {
							disabled: a,
							"aria-label": "From",
							value: i.source,
							onChange: (e) => d(r, `${e.currentTarget.value} -> ${i.target} when ${i.guard}`),
							children: c.map((e) => /* @__PURE__ */ R("option", { children: e }))
						}),
						"→",
						/* @__PURE__ */ R("select", {
							disabled: a,
							"aria-label": "To",
							value: i.target,
							onChange: (e) => d(r, `${i.source} -> ${e.currentTarget.value} when ${i.guard}`),
							children: c.map((e) => /* @__PURE__ */ R("option", { children: e }))
						}),
						/* @__PURE__ */ R(At, {
							label: `Guard ${r + 1} of ${n}`,
							value: i.guard,
							disabled: a,
							list: Ut(t),
							onWrite: (e) => d(r, `${i.source} -> ${i.target} when ${e}`)
						}),
						/* @__PURE__ */ R("span", {
							class: "reads " + (o ? "prior" : "after"),
							title: o ? "reads a priori values, x⁻" : "reads a posteriori values, x⁺",
							children: o ? "x⁻" : "x⁺"
						})
					] }) : /* @__PURE__ */ R(At, {
						label: `Rule ${r + 1} of ${n}`,
						value: e,
						disabled: a,
						onWrite: (e) => d(r, e)
					}), !a && /* @__PURE__ */ R("button", {
						class: "small",
						"aria-label": `Delete rule ${r + 1} of ${n}`,
						onClick: () => d(r, null),
						children: "✕"
					})]
				});
			}),
			!a && /* @__PURE__ */ R("div", {
				class: "row",
				children: [/* @__PURE__ */ R("button", {
					onClick: () => u({
						...r,
						states: {
							...r.states,
							[Vt(c, "state")]: []
						}
					}),
					children: "Add state"
				}), /* @__PURE__ */ R("button", {
					disabled: c.length < 2,
					onClick: () => {
						let e = c.find((e) => !l.some((t) => Wt(t)?.source === e)) ?? c[0], t = c.find((t) => t !== e);
						u({
							...r,
							rules: [...l, `${e} -> ${t} when time >= 1`]
						});
					},
					children: "Add rule"
				})]
			})
		]
	});
}
function qt({ machine: e, now: t, onState: n }) {
	let r = Object.keys(e.states ?? {}), i = (e) => 46 + 108 * r.indexOf(e), a = (e.rules ?? []).map(Wt).filter((e) => !!e && r.includes(e.source) && r.includes(e.target)), o = /* @__PURE__ */ new Map(), s = 26 + 16 * Math.max(1, ...a.map((e) => Math.abs(r.indexOf(e.target) - r.indexOf(e.source))));
	return /* @__PURE__ */ R("div", {
		class: "diagram",
		children: /* @__PURE__ */ R("svg", {
			width: 46 + 108 * r.length,
			height: 2 * s + 10,
			viewBox: `0 ${-s} ${46 + 108 * r.length} ${2 * s + 10}`,
			role: "group",
			"aria-label": "States and rules",
			children: [
				/* @__PURE__ */ R("defs", { children: /* @__PURE__ */ R("marker", {
					id: "rulehead",
					viewBox: "0 0 8 8",
					refX: 7,
					refY: 4,
					markerWidth: 7,
					markerHeight: 7,
					orient: "auto",
					children: /* @__PURE__ */ R("path", {
						d: "M0,1L8,4L0,7z",
						class: "rulehead"
					})
				}) }),
				a.map((e) => {
					let [t, n] = [i(e.source), i(e.target)], r = `${e.source}>${e.target}`, a = o.get(r) ?? 0;
					if (o.set(r, a + 1), t === n) return /* @__PURE__ */ R("path", {
						class: "arc",
						d: `M${t - 8},-14 C${t - 26},-44 ${t + 26},-44 ${t + 8},-14`,
						"marker-end": "url(#rulehead)",
						children: /* @__PURE__ */ R("title", { children: e.guard })
					});
					let s = n > t ? -1 : 1, c = s * (22 + 14 * Math.abs(n - t) / 108 + 9 * a), l = e.guard.length > 26 ? e.guard.slice(0, 25) + "…" : e.guard;
					return /* @__PURE__ */ R("g", { children: [/* @__PURE__ */ R("path", {
						class: "arc",
						d: `M${t},${14 * s} C${t},${c} ${n},${c} ${n},${14 * s}`,
						"marker-end": "url(#rulehead)",
						children: /* @__PURE__ */ R("title", { children: e.guard })
					}), /* @__PURE__ */ R("text", {
						class: "guard",
						x: (t + n) / 2,
						y: .78 * c + (s < 0 ? -3 : 10),
						"text-anchor": "middle",
						children: l
					})] });
				}),
				r.map((r) => /* @__PURE__ */ R("g", {
					class: "statebox" + (r === t ? " now" : "") + (r === e.start ? " start" : ""),
					role: "button",
					tabindex: 0,
					"aria-label": `Show state ${r}`,
					"aria-pressed": r === t,
					onClick: () => n(r),
					onKeyDown: (e) => (e.key === "Enter" || e.key === " ") && n(r),
					children: [
						/* @__PURE__ */ R("rect", {
							x: i(r) - 38,
							y: -14,
							width: 76,
							height: 28,
							rx: 8
						}),
						/* @__PURE__ */ R("text", {
							x: i(r),
							y: 4,
							"text-anchor": "middle",
							children: r.length > 11 ? r.slice(0, 10) + "…" : r
						}),
						r === e.start && /* @__PURE__ */ R("circle", {
							cx: i(r) - 38,
							cy: -14,
							r: 4
						})
					]
				}))
			]
		})
	});
}
// src/panels.tsx
function Jt({ store: e, state: t }) {
	let n = t.look, r = !n.view.editable, i = n.panels.experiment, a = (t, n) => e.edit({
		do: "set",
		path: t,
		value: n
	}), o = (i, o, s) => {
		let c = Object.entries(n.panels[i]);
		return /* @__PURE__ */ R(x, { children: [
			/* @__PURE__ */ R("h2", { children: o }),
			c.map(([n, r]) => /* @__PURE__ */ R(Xt, {
				store: e,
				state: t,
				section: i,
				name: n,
				value: r
			}, n)),
			!r && /* @__PURE__ */ R("button", {
				onClick: () => {
					let e = {
						parameters: "k",
						signals: "y",
						inputs: "u"
					}[i], t = [
						...Object.keys(n.panels.parameters),
						...n.view.nodes.map((e) => e.name),
						...n.view.signals.map((e) => e.name)
					];
					a([i, Vt(t, e)], s);
				},
				children: "Add"
			})
		] });
	};
	return /* @__PURE__ */ R("section", { children: [
		o("parameters", "Parameters", 1),
		o("signals", "Signals", "time"),
		o("inputs", "Inputs", { constant: 1 }),
		!t.level && /* @__PURE__ */ R(x, { children: [
			/* @__PURE__ */ R("h2", { children: "Run" }),
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "until" }), /* @__PURE__ */ R(At, {
				label: "Until",
				value: Ht(i.until),
				placeholder: "1 s",
				onWrite: (e) => void a(["experiment", "until"], jt(e))
			})] }),
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "solver" }), /* @__PURE__ */ R("select", {
				value: Ht(i.solver),
				onChange: (e) => void a(["experiment", "solver"], e.currentTarget.value || null),
				children: [/* @__PURE__ */ R("option", {
					value: "",
					children: "auto"
				}), t.stock?.solvers.filter((e) => e.name !== "auto").map((e) => /* @__PURE__ */ R("option", {
					value: e.name,
					title: e.about,
					children: e.name
				}))]
			})] }),
			/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: "rtol" }), /* @__PURE__ */ R(At, {
				label: "Relative tolerance",
				value: Ht(i.rtol),
				placeholder: "1e-8",
				onWrite: (e) => void a(["experiment", "rtol"], jt(e))
			})] })
		] })
	] });
}
var Yt = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(\s*\S.*)?$/i;
function Xt({ store: e, state: t, section: n, name: r, value: i }) {
	let a = !t.look.view.editable, o = typeof i != "object", s = n === "parameters" ? Yt.exec(Ht(i)) : null, [c] = lt(() => s && Number(s[1]) || 1);
	return /* @__PURE__ */ R("div", {
		class: "entry",
		"data-entry": r,
		children: [/* @__PURE__ */ R("label", { children: [
			/* @__PURE__ */ R(At, {
				label: `Name ${r}`,
				value: r,
				disabled: a,
				onWrite: (t) => void e.edit({
					do: "rename",
					old: r,
					new: t.trim()
				})
			}),
			o ? /* @__PURE__ */ R(At, {
				label: r,
				value: Ht(i),
				disabled: a,
				list: n === "signals" ? Ut(t) : void 0,
				onWrite: (t) => void e.edit({
					do: "set",
					path: [n, r],
					value: jt(t)
				})
			}) : /* @__PURE__ */ R(Zt, {
				store: e,
				path: [n, r],
				value: i,
				off: a
			}),
			!a && /* @__PURE__ */ R("button", {
				class: "small",
				"aria-label": `Delete ${r}`,
				onClick: () => void e.edit({
					do: "set",
					path: [n, r],
					value: null
				}),
				children: "✕"
			})
		] }), s && !a && /* @__PURE__ */ R("input", {
			type: "range",
			"aria-label": `Slider ${r}`,
			min: -1,
			max: 1,
			step: .02,
			value: Math.log10(Math.abs(Number(s[1]) || 1) / Math.abs(c)),
			onChange: (i) => {
				let a = +(Math.sign(c) * Math.abs(c) * 10 ** Number(i.currentTarget.value)).toPrecision(4), o = s[2] ?? "";
				e.edit({
					do: "set",
					path: [n, r],
					value: o ? `${a}${o}` : a
				}).then(() => t.run && e.start());
			}
		})]
	});
}
function Zt({ store: e, path: t, value: n, off: r }) {
	return /* @__PURE__ */ R("span", {
		class: "structured",
		children: Object.entries(n).map(([n, i]) => typeof i == "object" && i && !Array.isArray(i) ? /* @__PURE__ */ R(Zt, {
			store: e,
			path: [...t, n],
			value: i,
			off: r
		}) : /* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("span", { children: n }), /* @__PURE__ */ R(At, {
			label: `${t.join(" ")} ${n}`,
			value: Ht(i),
			disabled: r,
			onWrite: (r) => {
				let i = jt(r);
				if (r.trim().startsWith("[")) try {
					i = JSON.parse(r);
				} catch {}
				e.edit({
					do: "set",
					path: [...t, n],
					value: i
				});
			}
		})] }))
	});
}
function Qt({ store: e, state: t }) {
	let n = t.look.problems;
	return /* @__PURE__ */ R("section", { children: [
		/* @__PURE__ */ R("h2", { children: "Problems" }),
		!n.length && /* @__PURE__ */ R("p", { children: "None." }),
		/* @__PURE__ */ R("ul", {
			class: "problems",
			children: n.map((t) => /* @__PURE__ */ R("li", {
				class: t.grave,
				children: /* @__PURE__ */ R("button", {
					onClick: () => e.select(t.select),
					children: [
						/* @__PURE__ */ R("b", { children: t.code }),
						" ",
						t.where && /* @__PURE__ */ R("i", { children: t.where }),
						/* @__PURE__ */ R("span", { children: t.why }),
						t.try && /* @__PURE__ */ R("em", { children: ["Try: ", t.try] })
					]
				})
			}))
		})
	] });
}
function $t({ store: e, state: t }) {
	let { view: n, strokes: r } = t.look;
	return /* @__PURE__ */ R("section", {
		class: "tables",
		children: [
			/* @__PURE__ */ R("h2", { children: "Elements" }),
			/* @__PURE__ */ R("table", { children: [/* @__PURE__ */ R("thead", { children: /* @__PURE__ */ R("tr", { children: [
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "name"
				}),
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "kind"
				}),
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "value"
				}),
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "state"
				})
			] }) }), /* @__PURE__ */ R("tbody", { children: n.nodes.map((n) => {
				let i = r.nodes[n.name];
				return /* @__PURE__ */ R("tr", {
					class: t.nodes.has(n.name) ? "chosen" : "",
					children: [
						/* @__PURE__ */ R("td", { children: /* @__PURE__ */ R("button", {
							class: "link",
							onClick: () => e.set({
								nodes: /* @__PURE__ */ new Set([n.name]),
								bonds: /* @__PURE__ */ new Set()
							}),
							children: n.name
						}) }),
						/* @__PURE__ */ R("td", { children: n.kind === "part" ? String(n.entry.submodel) : n.kind }),
						/* @__PURE__ */ R("td", { children: i?.says ?? n.says }),
						/* @__PURE__ */ R("td", { children: [
							i?.off ? "OFF" : i?.controlled ? "ON" : "",
							i?.derivative ? "derivative" : "",
							n.law ?? "",
							n.machine ?? ""
						].filter(Boolean).join(", ") })
					]
				});
			}) })] }),
			/* @__PURE__ */ R("h2", { children: "Bonds" }),
			/* @__PURE__ */ R("table", { children: [/* @__PURE__ */ R("thead", { children: /* @__PURE__ */ R("tr", { children: [
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "bond"
				}),
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "stroke at"
				}),
				/* @__PURE__ */ R("th", {
					scope: "col",
					children: "other modes"
				})
			] }) }), /* @__PURE__ */ R("tbody", { children: n.bonds.map((n) => {
				let i = r.bonds[n.key] ?? r.bonds[`${n.ends[0]} -> ${n.ends[1]}`];
				return /* @__PURE__ */ R("tr", {
					class: t.bonds.has(n.key) ? "chosen" : "",
					children: [
						/* @__PURE__ */ R("td", { children: /* @__PURE__ */ R("button", {
							class: "link",
							onClick: () => e.set({
								bonds: /* @__PURE__ */ new Set([n.key]),
								nodes: /* @__PURE__ */ new Set()
							}),
							children: n.text
						}) }),
						/* @__PURE__ */ R("td", { children: i ? i.strokes.map((e) => n.ends[e]).join(", ") + (i.conflict ? " (conflict)" : "") + (i.off ? " (OFF)" : "") : "—" }),
						/* @__PURE__ */ R("td", { children: i?.dashed?.map((e) => n.ends[e]).join(", ") ?? "" })
					]
				});
			}) })] })
		]
	});
}
function en({ store: e, state: t }) {
	let [n, r] = lt(null), [i, a] = lt(null), o = t.look.revision;
	dt(() => {
		let t = !1;
		return e.transport.ask("text").then((e) => !t && r(e)).catch(() => {}), () => {
			t = !0;
		};
	}, [o]);
	let s = () => {
		i !== null && e.ask("replace", { text: i }).then((e) => e && a(null));
	};
	return /* @__PURE__ */ R("section", {
		class: "textpanel",
		children: [
			/* @__PURE__ */ R("h2", { children: [
				t.look.file,
				" ",
				i !== null && /* @__PURE__ */ R("small", { children: "not applied" })
			] }),
			/* @__PURE__ */ R("textarea", {
				"aria-label": "Text of the model file",
				spellcheck: !1,
				value: i ?? n?.text ?? "",
				onInput: (e) => a(e.currentTarget.value),
				onKeyDown: (e) => {
					e.key === "Enter" && (e.ctrlKey || e.metaKey) && s(), e.stopPropagation();
				}
			}),
			/* @__PURE__ */ R("div", {
				class: "row",
				children: [/* @__PURE__ */ R("button", {
					disabled: i === null,
					onClick: s,
					children: "Apply (Ctrl+Enter)"
				}), /* @__PURE__ */ R("button", {
					disabled: i === null,
					onClick: () => a(null),
					children: "Discard"
				})]
			})
		]
	});
}
// src/palette.tsx
function tn(e) {
	let t = e.stock, n = (t?.kinds ?? []).map((e) => ({
		key: e.kind,
		letters: e.kind === "G" ? "G" : e.letters,
		about: e.about,
		element: e.element,
		stem: e.stem
	})), r = /* @__PURE__ */ new Map();
	for (let e of t?.parts ?? []) {
		let [t, n] = e.name.split("."), i = {
			key: e.name,
			letters: n,
			about: e.title,
			element: { submodel: e.name },
			stem: n
		};
		r.set(t, [...r.get(t) ?? [], i]);
	}
	return {
		kinds: n,
		parts: r
	};
}
function nn({ store: e, state: t }) {
	let [n, r] = lt(""), { kinds: i, parts: a } = tn(t), o = t.look?.view.domain ?? "", s = n.toLowerCase().split(/\s+/).filter(Boolean), c = (e) => s.every((t) => `${e.key} ${e.about}`.toLowerCase().includes(t)), l = [...a].sort(([e], [t]) => Number(t === o) - Number(e === o)), u = (e) => (t) => t.dataTransfer.setData("application/x-hybond", JSON.stringify({
		element: e.element,
		stem: e.stem
	})), d = (t) => {
		e.add(t.element, t.stem), e.set({ panel: "" });
	}, f = !t.look?.view.editable;
	return /* @__PURE__ */ R("aside", {
		class: "palette" + (t.panel === "palette" ? " open" : ""),
		"aria-label": "Palette",
		children: [
			/* @__PURE__ */ R("div", {
				class: "kinds",
				children: i.map((e) => /* @__PURE__ */ R("button", {
					disabled: f,
					draggable: !0,
					onDragStart: u(e),
					onClick: () => d(e),
					title: e.about,
					"aria-label": `Add ${e.key}, ${e.about}`,
					"data-kind": e.key,
					children: e.letters
				}))
			}),
			/* @__PURE__ */ R("input", {
				type: "search",
				placeholder: "Parts …",
				"aria-label": "Search parts",
				value: n,
				onInput: (e) => r(e.currentTarget.value)
			}),
			/* @__PURE__ */ R("div", {
				class: "shelves",
				tabindex: 0,
				role: "region",
				"aria-label": "Ready parts",
				children: l.map(([e, t]) => {
					let n = t.filter(c);
					return n.length ? /* @__PURE__ */ R("details", {
						open: s.length > 0 || e === o,
						children: [/* @__PURE__ */ R("summary", { children: [
							e,
							" ",
							/* @__PURE__ */ R("small", { children: n.length })
						] }), n.map((e) => /* @__PURE__ */ R("button", {
							class: "offer",
							disabled: f,
							draggable: !0,
							onDragStart: u(e),
							onClick: () => d(e),
							title: e.about,
							"data-part": e.key,
							children: e.letters.replaceAll("_", " ")
						}))]
					}) : null;
				})
			})
		]
	});
}
function rn({ store: e, state: t }) {
	let [n, r] = lt(""), { kinds: i, parts: a } = tn(t), o = [...i, ...[...a.values()].flat()], [s, ...c] = n.trim().split(/\s+/), l = i.find((e) => e.key === s), u = n.includes("->") ? [] : l ? [l, ...o.filter((e) => e !== l && e.key.includes(s))] : o.filter((e) => `${e.key} ${e.about}`.toLowerCase().includes(n.trim().toLowerCase())), d = () => {
		document.querySelector(".canvas svg")?.focus(), e.set({ adding: !1 });
	}, f = async () => {
		if (n.includes("->")) return await e.edit({
			do: "write bond",
			text: n.trim()
		}), d();
		let t = u[0];
		if (!t) return;
		let r = t.element, i = "";
		if (t === l && c.length) {
			/^[A-Za-z_]\w*$/.test(c[0]) && (i = c.shift());
			let e = c.join(" ");
			e && !("junction" in r) && (r = { [t.key]: e });
		}
		await e.add(r, i || t.stem), d();
	};
	return /* @__PURE__ */ R("div", {
		class: "quick",
		role: "dialog",
		"aria-label": "Add",
		children: [/* @__PURE__ */ R("input", {
			ref: (e) => e?.focus(),
			value: n,
			"aria-label": "What to add",
			placeholder: "R load 10 ohm · diode · a -> b",
			onInput: (e) => r(e.currentTarget.value),
			onKeyDown: (e) => {
				e.key === "Enter" && f(), e.key === "Escape" && d(), e.stopPropagation();
			}
		}), /* @__PURE__ */ R("ul", { children: u.slice(0, 8).map((e, t) => /* @__PURE__ */ R("li", {
			class: t === 0 ? "chosen" : "",
			children: [
				/* @__PURE__ */ R("b", { children: e.letters }),
				" ",
				e.about
			]
		})) })]
	});
}
// node_modules/uplot/dist/uPlot.esm.js
var an = !0, on = "uplot", sn = "u-hz", cn = "u-vt", ln = "u-title", un = "u-wrap", dn = "u-under", fn = "u-over", pn = "u-axis", mn = "u-off", hn = "u-select", gn = "u-cursor-x", _n = "u-cursor-y", vn = "u-cursor-pt", yn = "u-legend", bn = "u-live", xn = "u-inline", Sn = "u-series", Cn = "u-marker", wn = "u-label", Tn = "u-value", En = "width", Dn = "height", On = "top", kn = "bottom", An = "left", jn = "right", U = "#000", Mn = "#0000", Nn = "mousemove", Pn = "mousedown", Fn = "mouseup", In = "mouseenter", Ln = "mouseleave", Rn = "dblclick", W = "resize", zn = "scroll", Bn = "change", Vn = "dppxchange", Hn = "--", G = typeof window < "u", Un = G ? document : null, Wn = G ? window : null, Gn = G ? navigator : null, K, q;
function Kn() {
	let e = devicePixelRatio;
	K != e && (K = e, q && or(Bn, q, Kn), q = matchMedia(`(min-resolution: ${K - .001}dppx) and (max-resolution: ${K + .001}dppx)`), ar(Bn, q, Kn), Wn.dispatchEvent(new CustomEvent(Vn)));
}
function qn(e, t) {
	if (t != null) {
		let n = e.classList;
		!n.contains(t) && n.add(t);
	}
}
function Jn(e, t) {
	let n = e.classList;
	n.contains(t) && n.remove(t);
}
function J(e, t, n) {
	e.style[t] = n + "px";
}
function Yn(e, t, n, r) {
	let i = Un.createElement(e);
	return t != null && qn(i, t), n?.insertBefore(i, r), i;
}
function Xn(e, t) {
	return Yn("div", e, t);
}
var Zn = /* @__PURE__ */ new WeakMap();
function Qn(e, t, n, r, i) {
	let a = "translate(" + t + "px," + n + "px)";
	a != Zn.get(e) && (e.style.transform = a, Zn.set(e, a), t < 0 || n < 0 || t > r || n > i ? qn(e, mn) : Jn(e, mn));
}
var $n = /* @__PURE__ */ new WeakMap();
function er(e, t, n) {
	let r = t + n;
	r != $n.get(e) && ($n.set(e, r), e.style.background = t, e.style.borderColor = n);
}
var tr = /* @__PURE__ */ new WeakMap();
function nr(e, t, n, r) {
	let i = t + "" + n;
	i != tr.get(e) && (tr.set(e, i), e.style.height = n + "px", e.style.width = t + "px", e.style.marginLeft = r ? -t / 2 + "px" : 0, e.style.marginTop = r ? -n / 2 + "px" : 0);
}
var rr = { passive: !0 }, ir = {
	...rr,
	capture: !0
};
function ar(e, t, n, r) {
	t.addEventListener(e, n, r ? ir : rr);
}
function or(e, t, n, r) {
	t.removeEventListener(e, n, rr);
}
G && Kn();
function sr(e, t, n, r) {
	let i;
	n ||= 0, r ||= t.length - 1;
	let a = r <= 2147483647;
	for (; r - n > 1;) i = a ? n + r >> 1 : Or((n + r) / 2), t[i] < e ? n = i : r = i;
	return e - t[n] <= t[r] - e ? n : r;
}
function cr(e) {
	return (t, n, r) => {
		let i = -1, a = -1;
		for (let a = n; a <= r; a++) if (e(t[a])) {
			i = a;
			break;
		}
		for (let i = r; i >= n; i--) if (e(t[i])) {
			a = i;
			break;
		}
		return [i, a];
	};
}
var lr = (e) => e != null, ur = (e) => e != null && e > 0, dr = cr(lr), fr = cr(ur);
function pr(e, t, n, r = 0, i = !1) {
	let a = i ? fr : dr, o = i ? ur : lr;
	[t, n] = a(e, t, n);
	let s = e[t], c = e[t];
	if (t > -1) {
		if (r == 1) s = e[t], c = e[n];
		else if (r == -1) s = e[n], c = e[t];
		else for (let r = t; r <= n; r++) {
			let t = e[r];
			o(t) && (t < s ? s = t : t > c && (c = t));
		}
	}
	return [s ?? X, c ?? -X];
}
function mr(e, t, n, r) {
	let i = Pr(e), a = Pr(t);
	e == t && (i == -1 ? (e *= n, t /= n) : (e /= n, t *= n));
	let o = n == 10 ? Fr : Ir, s = i == 1 ? Or : Ar, c = a == 1 ? Ar : Or, l = s(o(Dr(e))), u = c(o(Dr(t))), d = Nr(n, l), f = Nr(n, u);
	return n == 10 && (l < 0 && (d = Q(d, -l)), u < 0 && (f = Q(f, -u))), r || n == 2 ? (e = d * i, t = f * a) : (e = Qr(e, d), t = Zr(t, f)), [e, t];
}
function hr(e, t, n, r) {
	let i = mr(e, t, n, r);
	return e == 0 && (i[0] = 0), t == 0 && (i[1] = 0), i;
}
var gr = .1, _r = {
	mode: 3,
	pad: gr
}, vr = {
	pad: 0,
	soft: null,
	mode: 0
}, yr = {
	min: vr,
	max: vr
};
function br(e, t, n, r) {
	return li(n) ? Sr(e, t, n) : (vr.pad = n, vr.soft = r ? 0 : null, vr.mode = r ? 3 : 0, Sr(e, t, yr));
}
function Y(e, t) {
	return e ?? t;
}
function xr(e, t, n) {
	for (t = Y(t, 0), n = Y(n, e.length - 1); t <= n;) {
		if (e[t] != null) return !0;
		t++;
	}
	return !1;
}
function Sr(e, t, n) {
	let r = n.min, i = n.max, a = Y(r.pad, 0), o = Y(i.pad, 0), s = Y(r.hard, -X), c = Y(i.hard, X), l = Y(r.soft, X), u = Y(i.soft, -X), d = Y(r.mode, 0), f = Y(i.mode, 0), p = t - e, m = Fr(p), h = Mr(Dr(e), Dr(t)), g = Dr(Fr(h) - m);
	(p < 1e-24 || g > 10) && (p = 0, (e == 0 || t == 0) && (p = 1e-24, d == 2 && l != X && (a = 0), f == 2 && u != -X && (o = 0)));
	let _ = p || h || 1e3, v = Nr(10, Or(Fr(_))), y = Q(Qr(e - _ * (p == 0 ? e == 0 ? .1 : 1 : a), v / 10), 24), b = e >= l && (d == 1 || d == 3 && y <= l || d == 2 && y >= l) ? l : X, x = Mr(s, y < b && e >= b ? b : jr(b, y)), S = Q(Zr(t + _ * (p == 0 ? t == 0 ? .1 : 1 : o), v / 10), 24), C = t <= u && (f == 1 || f == 3 && S >= u || f == 2 && S <= u) ? u : -X, w = jr(c, S > C && t <= C ? C : Mr(C, S));
	return x == w && x == 0 && (w = 100), [x, w];
}
var Cr = new Intl.NumberFormat(G ? Gn.language : "en-US"), wr = (e) => Cr.format(e), Tr = Math, Er = Tr.PI, Dr = Tr.abs, Or = Tr.floor, kr = Tr.round, Ar = Tr.ceil, jr = Tr.min, Mr = Tr.max, Nr = Tr.pow, Pr = Tr.sign, Fr = Tr.log10, Ir = Tr.log2, Lr = (e, t = 1) => Tr.sinh(e) * t, Rr = (e, t = 1) => Tr.asinh(e / t), X = Infinity;
function zr(e) {
	return (Fr((e ^ e >> 31) - (e >> 31)) | 0) + 1;
}
function Br(e, t, n) {
	return jr(Mr(e, t), n);
}
function Vr(e) {
	return typeof e == "function";
}
function Z(e) {
	return Vr(e) ? e : () => e;
}
var Hr = () => {}, Ur = (e) => e, Wr = (e, t) => t, Gr = (e) => null, Kr = (e) => !0, qr = (e, t) => e == t, Jr = /\.\d*?(?=9{6,}|0{6,})/gm, Yr = (e) => {
	if (oi(e) || $r.has(e)) return e;
	let t = `${e}`, n = t.match(Jr);
	if (n == null) return e;
	let r = n[0].length - 1;
	if (t.indexOf("e-") != -1) {
		let [e, n] = t.split("e");
		return +`${Yr(e)}e${n}`;
	}
	return Q(e, r);
};
function Xr(e, t) {
	return Yr(Q(Yr(e / t)) * t);
}
function Zr(e, t) {
	return Yr(Ar(Yr(e / t)) * t);
}
function Qr(e, t) {
	return Yr(Or(Yr(e / t)) * t);
}
function Q(e, t = 0) {
	if (oi(e)) return e;
	let n = 10 ** t;
	return kr(e * n * (1 + 2 ** -52)) / n;
}
var $r = /* @__PURE__ */ new Map();
function ei(e) {
	return (("" + e).split(".")[1] || "").length;
}
function ti(e, t, n, r) {
	let i = [], a = r.map(ei);
	for (let o = t; o < n; o++) {
		let t = Dr(o), n = Q(Nr(e, o), t);
		for (let s = 0; s < r.length; s++) {
			let c = e == 10 ? +`${r[s]}e${o}` : r[s] * n, l = (o >= 0 ? 0 : t) + (o >= a[s] ? 0 : a[s]), u = e == 10 ? c : Q(c, l);
			i.push(u), $r.set(u, l);
		}
	}
	return i;
}
var ni = {}, ri = [], ii = [null, null], ai = Array.isArray, oi = Number.isInteger, si = (e) => e === void 0;
function ci(e) {
	return typeof e == "string";
}
function li(e) {
	let t = !1;
	if (e != null) {
		let n = e.constructor;
		t = n == null || n == Object;
	}
	return t;
}
function ui(e) {
	return typeof e == "object" && !!e;
}
var di = Object.getPrototypeOf(Uint8Array), fi = "__proto__";
function pi(e, t = li) {
	let n;
	if (ai(e)) {
		let r = e.find((e) => e != null);
		if (ai(r) || t(r)) {
			n = Array(e.length);
			for (let r = 0; r < e.length; r++) n[r] = pi(e[r], t);
		} else n = e.slice();
	} else if (e instanceof di) n = e.slice();
	else if (t(e)) {
		n = {};
		for (let r in e) r != fi && (n[r] = pi(e[r], t));
	} else n = e;
	return n;
}
function mi(e) {
	let t = arguments;
	for (let n = 1; n < t.length; n++) {
		let r = t[n];
		for (let t in r) t != fi && (li(e[t]) ? mi(e[t], pi(r[t])) : e[t] = pi(r[t]));
	}
	return e;
}
var hi = 0, gi = 1, _i = 2;
function vi(e, t, n) {
	for (let r = 0, i, a = -1; r < t.length; r++) {
		let o = t[r];
		if (o > a) {
			for (i = o - 1; i >= 0 && e[i] == null;) e[i--] = null;
			for (i = o + 1; i < n && e[i] == null;) e[a = i++] = null;
		}
	}
}
function yi(e, t) {
	if (Si(e)) {
		let t = e[0].slice();
		for (let n = 1; n < e.length; n++) t.push(...e[n].slice(1));
		return Ci(t[0]) || (t = xi(t)), t;
	}
	let n = /* @__PURE__ */ new Set();
	for (let t = 0; t < e.length; t++) {
		let r = e[t][0], i = r.length;
		for (let e = 0; e < i; e++) n.add(r[e]);
	}
	let r = [Array.from(n).sort((e, t) => e - t)], i = r[0].length, a = /* @__PURE__ */ new Map();
	for (let e = 0; e < i; e++) a.set(r[0][e], e);
	for (let n = 0; n < e.length; n++) {
		let o = e[n], s = o[0];
		for (let e = 1; e < o.length; e++) {
			let c = o[e], l = Array(i).fill(void 0), u = t ? t[n][e] : gi, d = [];
			for (let e = 0; e < c.length; e++) {
				let t = c[e], n = a.get(s[e]);
				t === null ? u != hi && (l[n] = t, u == _i && d.push(n)) : l[n] = t;
			}
			vi(l, d, i), r.push(l);
		}
	}
	return r;
}
var bi = typeof queueMicrotask > "u" ? (e) => Promise.resolve().then(e) : queueMicrotask;
function xi(e) {
	let t = e[0], n = t.length, r = Array(n);
	for (let e = 0; e < r.length; e++) r[e] = e;
	r.sort((e, n) => t[e] - t[n]);
	let i = [];
	for (let t = 0; t < e.length; t++) {
		let a = e[t], o = Array(n);
		for (let e = 0; e < n; e++) o[e] = a[r[e]];
		i.push(o);
	}
	return i;
}
function Si(e) {
	let t = e[0][0], n = t.length;
	for (let r = 1; r < e.length; r++) {
		let i = e[r][0];
		if (i.length != n) return !1;
		if (i != t) {
			for (let e = 0; e < n; e++) if (i[e] != t[e]) return !1;
		}
	}
	return !0;
}
function Ci(e, t = 100) {
	let n = e.length;
	if (n <= 1) return !0;
	let r = 0, i = n - 1;
	for (; r <= i && e[r] == null;) r++;
	for (; i >= r && e[i] == null;) i--;
	if (i <= r) return !0;
	let a = Mr(1, Or((i - r + 1) / t));
	for (let t = e[r], n = r + a; n <= i; n += a) {
		let r = e[n];
		if (r != null) {
			if (r <= t) return !1;
			t = r;
		}
	}
	return !0;
}
var wi = [
	"January",
	"February",
	"March",
	"April",
	"May",
	"June",
	"July",
	"August",
	"September",
	"October",
	"November",
	"December"
], Ti = [
	"Sunday",
	"Monday",
	"Tuesday",
	"Wednesday",
	"Thursday",
	"Friday",
	"Saturday"
];
function Ei(e) {
	return e.slice(0, 3);
}
var Di = Ti.map(Ei), Oi = {
	MMMM: wi,
	MMM: wi.map(Ei),
	WWWW: Ti,
	WWW: Di
};
function ki(e) {
	return (e < 10 ? "0" : "") + e;
}
function Ai(e) {
	return (e < 10 ? "00" : e < 100 ? "0" : "") + e;
}
var ji = {
	YYYY: (e) => e.getFullYear(),
	YY: (e) => (e.getFullYear() + "").slice(2),
	MMMM: (e, t) => t.MMMM[e.getMonth()],
	MMM: (e, t) => t.MMM[e.getMonth()],
	MM: (e) => ki(e.getMonth() + 1),
	M: (e) => e.getMonth() + 1,
	DD: (e) => ki(e.getDate()),
	D: (e) => e.getDate(),
	WWWW: (e, t) => t.WWWW[e.getDay()],
	WWW: (e, t) => t.WWW[e.getDay()],
	HH: (e) => ki(e.getHours()),
	H: (e) => e.getHours(),
	h: (e) => {
		let t = e.getHours();
		return t == 0 ? 12 : t > 12 ? t - 12 : t;
	},
	AA: (e) => e.getHours() >= 12 ? "PM" : "AM",
	aa: (e) => e.getHours() >= 12 ? "pm" : "am",
	a: (e) => e.getHours() >= 12 ? "p" : "a",
	mm: (e) => ki(e.getMinutes()),
	m: (e) => e.getMinutes(),
	ss: (e) => ki(e.getSeconds()),
	s: (e) => e.getSeconds(),
	fff: (e) => Ai(e.getMilliseconds())
};
function Mi(e, t) {
	t ||= Oi;
	let n = [], r = /\{([a-z]+)\}|[^{]+/gi, i;
	for (; i = r.exec(e);) n.push(i[0][0] == "{" ? ji[i[1]] : i[0]);
	return (e) => {
		let r = "";
		for (let i = 0; i < n.length; i++) r += typeof n[i] == "string" ? n[i] : n[i](e, t);
		return r;
	};
}
var Ni = new Intl.DateTimeFormat().resolvedOptions().timeZone;
function Pi(e, t) {
	let n;
	return t == "UTC" || t == "Etc/UTC" ? n = /* @__PURE__ */ new Date(+e + e.getTimezoneOffset() * 6e4) : t == Ni ? n = e : (n = new Date(e.toLocaleString("en-US", { timeZone: t })), n.setMilliseconds(e.getMilliseconds())), n;
}
var Fi = (e) => e % 1 == 0, Ii = [
	1,
	2,
	2.5,
	5
], Li = ti(10, -32, 0, Ii), Ri = ti(10, 0, 32, Ii), zi = Ri.filter(Fi), Bi = Li.concat(Ri), Vi = "\n", Hi = "{YYYY}", Ui = Vi + Hi, Wi = "{M}/{D}", Gi = Vi + Wi, Ki = Gi + "/{YY}", qi = "{aa}", Ji = "{h}:{mm}" + qi, Yi = Vi + Ji, Xi = ":{ss}", $ = null;
function Zi(e) {
	let t = e * 1e3, n = t * 60, r = n * 60, i = r * 24, a = i * 30, o = i * 365, s = (e == 1 ? ti(10, 0, 3, Ii).filter(Fi) : ti(10, -3, 0, Ii)).concat([
		t,
		t * 5,
		t * 10,
		t * 15,
		t * 30,
		n,
		n * 5,
		n * 10,
		n * 15,
		n * 30,
		r,
		r * 2,
		r * 3,
		r * 4,
		r * 6,
		r * 8,
		r * 12,
		i,
		i * 2,
		i * 3,
		i * 4,
		i * 5,
		i * 6,
		i * 7,
		i * 8,
		i * 9,
		i * 10,
		i * 15,
		a,
		a * 2,
		a * 3,
		a * 4,
		a * 6,
		o,
		o * 2,
		o * 5,
		o * 10,
		o * 25,
		o * 50,
		o * 100
	]), c = [
		[
			o,
			Hi,
			$,
			$,
			$,
			$,
			$,
			$,
			1
		],
		[
			i * 28,
			"{MMM}",
			Ui,
			$,
			$,
			$,
			$,
			$,
			1
		],
		[
			i,
			Wi,
			Ui,
			$,
			$,
			$,
			$,
			$,
			1
		],
		[
			r,
			"{h}" + qi,
			Ki,
			$,
			Gi,
			$,
			$,
			$,
			1
		],
		[
			n,
			Ji,
			Ki,
			$,
			Gi,
			$,
			$,
			$,
			1
		],
		[
			t,
			Xi,
			Ki + " " + Ji,
			$,
			Gi + " " + Ji,
			$,
			Yi,
			$,
			1
		],
		[
			e,
			Xi + ".{fff}",
			Ki + " " + Ji,
			$,
			Gi + " " + Ji,
			$,
			Yi,
			$,
			1
		]
	];
	function l(t) {
		return (s, c, l, u, d, f) => {
			let p = [], m = d >= o, h = d >= a && d < o, g = t(l), _ = Q(g * e, 3), v = sa(g.getFullYear(), m ? 0 : g.getMonth(), h || m ? 1 : g.getDate()), y = Q(v * e, 3);
			if (h || m) {
				let n = h ? d / a : 0, r = m ? d / o : 0, i = _ == y ? _ : Q(sa(v.getFullYear() + r, v.getMonth() + n, 1) * e, 3), s = new Date(kr(i / e)), c = s.getFullYear(), l = s.getMonth();
				for (let a = 0; i <= u; a++) {
					let o = sa(c + r * a, l + n * a, 1), s = o - t(Q(o * e, 3));
					i = Q((+o + s) * e, 3), i <= u && p.push(i);
				}
			} else {
				let a = d >= i ? i : d, o = y + (Or(l) - Or(_)) + Zr(_ - y, a);
				p.push(o);
				let m = t(o), h = m.getHours() + m.getMinutes() / n + m.getSeconds() / r, g = d / r, v = f / s.axes[c]._space;
				for (; o = Q(o + d, e == 1 ? 0 : 3), !(o > u);) if (g > 1) {
					let e = Or(Q(h + g, 6)) % 24, n = t(o).getHours() - e;
					n > 1 && (n = -1), o -= n * r, h = (h + g) % 24;
					let i = p[p.length - 1];
					Q((o - i) / d, 3) * v >= .7 && p.push(o);
				} else p.push(o);
			}
			return p;
		};
	}
	return [
		s,
		c,
		l
	];
}
var [Qi, $i, ea] = Zi(1), [ta, na, ra] = Zi(.001);
ti(2, -53, 53, [1]);
function ia(e, t) {
	return e.map((e) => e.map((n, r) => r == 0 || r == 8 || n == null ? n : t(r == 1 || e[8] == 0 ? n : e[1] + n)));
}
function aa(e, t) {
	return (n, r, i, a, o) => {
		let s = t.find((e) => o >= e[0]) || t[t.length - 1], c, l, u, d, f, p;
		return r.map((t) => {
			let n = e(t), r = n.getFullYear(), i = n.getMonth(), a = n.getDate(), o = n.getHours(), m = n.getMinutes(), h = n.getSeconds(), g = r != c && s[2] || i != l && s[3] || a != u && s[4] || o != d && s[5] || m != f && s[6] || h != p && s[7] || s[1];
			return c = r, l = i, u = a, d = o, f = m, p = h, g(n);
		});
	};
}
function oa(e, t) {
	let n = Mi(t);
	return (t, r, i, a, o) => r.map((t) => n(e(t)));
}
function sa(e, t, n) {
	return new Date(e, t, n);
}
function ca(e, t) {
	return t(e);
}
var la = "{YYYY}-{MM}-{DD} {h}:{mm}{aa}";
function ua(e, t) {
	return (n, r, i, a) => a == null ? Hn : t(e(r));
}
function da(e, t) {
	let n = e.series[t];
	return n.width ? n.stroke(e, t) : n.points.width ? n.points.stroke(e, t) : null;
}
function fa(e, t) {
	return e.series[t].fill(e, t);
}
var pa = {
	show: !0,
	live: !0,
	isolate: !1,
	mount: Hr,
	markers: {
		show: !0,
		width: 2,
		stroke: da,
		fill: fa,
		dash: "solid"
	},
	idx: null,
	idxs: null,
	values: []
};
function ma(e, t) {
	let n = e.cursor.points, r = Xn(), i = n.size(e, t);
	J(r, En, i), J(r, Dn, i);
	let a = i / -2;
	J(r, "marginLeft", a), J(r, "marginTop", a);
	let o = n.width(e, t, i);
	return o && J(r, "borderWidth", o), r;
}
function ha(e, t) {
	let n = e.series[t].points;
	return n._fill || n._stroke;
}
function ga(e, t) {
	let n = e.series[t].points;
	return n._stroke || n._fill;
}
function _a(e, t) {
	return e.series[t].points.size;
}
var va = [0, 0];
function ya(e, t, n) {
	return va[0] = t, va[1] = n, va;
}
function ba(e, t, n, r = !0) {
	return (e) => {
		e.button != 0 || r && e.target != t || n(e);
	};
}
function xa(e, t, n, r = !0) {
	return (e) => {
		r && e.target != t || n(e);
	};
}
var Sa = {
	show: !0,
	x: !0,
	y: !0,
	lock: !1,
	move: ya,
	points: {
		one: !1,
		show: ma,
		size: _a,
		width: 0,
		stroke: ga,
		fill: ha
	},
	bind: {
		mousedown: ba,
		mouseup: ba,
		click: ba,
		dblclick: ba,
		mousemove: xa,
		mouseleave: xa,
		mouseenter: xa
	},
	drag: {
		setScale: !0,
		x: !0,
		y: !1,
		dist: 0,
		uni: null,
		click: (e, t) => {
			t.stopPropagation(), t.stopImmediatePropagation();
		},
		_x: !1,
		_y: !1
	},
	focus: {
		dist: (e, t, n, r, i) => r - i,
		prox: -1,
		bias: 0
	},
	hover: {
		skip: [void 0],
		prox: null,
		bias: 0
	},
	left: -10,
	top: -10,
	idx: null,
	dataIdx: null,
	idxs: null,
	event: null
}, Ca = {
	show: !0,
	stroke: "rgba(0,0,0,0.07)",
	width: 2
}, wa = mi({}, Ca, { filter: Wr }), Ta = mi({}, wa, { size: 10 }), Ea = mi({}, Ca, { show: !1 }), Da = "12px system-ui, -apple-system, \"Segoe UI\", Roboto, \"Helvetica Neue\", Arial, \"Noto Sans\", sans-serif, \"Apple Color Emoji\", \"Segoe UI Emoji\", \"Segoe UI Symbol\", \"Noto Color Emoji\"", Oa = "bold " + Da, ka = 1.5, Aa = {
	show: !0,
	scale: "x",
	stroke: U,
	space: 50,
	gap: 5,
	alignTo: 1,
	size: 50,
	labelGap: 0,
	labelSize: 30,
	labelFont: Oa,
	side: 2,
	grid: wa,
	ticks: Ta,
	border: Ea,
	font: Da,
	lineGap: ka,
	rotate: 0
}, ja = "Value", Ma = "Time", Na = {
	show: !0,
	scale: "x",
	auto: !1,
	sorted: 1,
	min: X,
	max: -Infinity,
	idxs: []
};
function Pa(e, t, n, r, i) {
	return t.map((e) => e == null ? "" : wr(e));
}
function Fa(e, t, n, r, i, a, o) {
	let s = [], c = $r.get(i) || 0;
	n = o ? n : Q(Zr(n, i), c);
	for (let e = n; e <= r; e = Q(e + i, c)) s.push(Object.is(e, -0) ? 0 : e);
	return s;
}
function Ia(e, t, n, r, i, a, o) {
	let s = [], c = e.scales[e.axes[t].scale].log;
	i = Nr(c, Or((c == 10 ? Fr : Ir)(n))), c == 10 && (i = Bi[sr(i, Bi)]);
	let l = n, u = i * c;
	c == 10 && (u = Bi[sr(u, Bi)]);
	do
		s.push(l), l += i, c == 10 && !$r.has(l) && (l = Q(l, $r.get(i))), l >= u && (i = l, u = i * c, c == 10 && (u = Bi[sr(u, Bi)]));
	while (l <= r);
	return s;
}
function La(e, t, n, r, i, a, o) {
	let s = e.scales[e.axes[t].scale].asinh, c = r > s ? Ia(e, t, Mr(s, n), r, i) : [s], l = r >= 0 && n <= 0 ? [0] : [];
	return (n < -s ? Ia(e, t, Mr(s, -r), -n, i) : [s]).reverse().map((e) => -e).concat(l, c);
}
var Ra = /./, za = /[12357]/, Ba = /[125]/, Va = /1/, Ha = (e, t, n, r) => e.map((e, i) => t == 4 && e == 0 || i % r == 0 && n.test(e.toExponential()[+(e < 0)]) ? e : null);
function Ua(e, t, n, r, i) {
	let a = e.axes[n], o = a.scale, s = e.scales[o], c = e.valToPos, l = a._space, u = c(10, o), d = c(9, o) - u >= l ? Ra : c(7, o) - u >= l ? za : c(5, o) - u >= l ? Ba : Va;
	if (d == Va) {
		let e = Dr(c(1, o) - u);
		if (e < l) return Ha(t.slice().reverse(), s.distr, d, Ar(l / e)).reverse();
	}
	return Ha(t, s.distr, d, 1);
}
function Wa(e, t, n, r, i) {
	let a = e.axes[n], o = a.scale, s = a._space, c = e.valToPos, l = Dr(c(1, o) - c(2, o));
	return l < s ? Ha(t.slice().reverse(), 3, Ra, Ar(s / l)).reverse() : t;
}
function Ga(e, t, n, r) {
	return r == null ? Hn : t == null ? "" : wr(t);
}
var Ka = {
	show: !0,
	scale: "y",
	stroke: U,
	space: 30,
	gap: 5,
	alignTo: 1,
	size: 50,
	labelGap: 0,
	labelSize: 30,
	labelFont: Oa,
	side: 3,
	grid: wa,
	ticks: Ta,
	border: Ea,
	font: Da,
	lineGap: ka,
	rotate: 0
};
function qa(e, t) {
	return Q((3 + (e || 1) * 2) * t, 3);
}
function Ja(e, t) {
	let { scale: n, idxs: r } = e.series[0], i = e._data[0], a = e.valToPos(i[r[0]], n, !0), o = Dr(e.valToPos(i[r[1]], n, !0) - a) / (e.series[t].points.space * K);
	return r[1] - r[0] <= o;
}
var Ya = {
	scale: null,
	auto: !0,
	sorted: 0,
	min: X,
	max: -Infinity
}, Xa = (e, t, n, r, i) => i, Za = {
	show: !0,
	auto: !0,
	sorted: 0,
	gaps: Xa,
	alpha: 1,
	facets: [mi({}, Ya, { scale: "x" }), mi({}, Ya, { scale: "y" })]
}, Qa = {
	scale: "y",
	auto: !0,
	sorted: 0,
	show: !0,
	spanGaps: !1,
	gaps: Xa,
	alpha: 1,
	points: {
		show: Ja,
		filter: null
	},
	values: null,
	min: X,
	max: -Infinity,
	idxs: [],
	path: null,
	clip: null
};
function $a(e, t, n, r, i) {
	return n / 10;
}
var eo = {
	time: an,
	auto: !0,
	distr: 1,
	log: 10,
	asinh: 1,
	min: null,
	max: null,
	dir: 1,
	ori: 0
}, to = mi({}, eo, {
	time: !1,
	ori: 1
}), no = {};
function ro(e, t) {
	let n = no[e];
	return n || (n = {
		key: e,
		plots: [],
		sub(e) {
			n.plots.push(e);
		},
		unsub(e) {
			n.plots = n.plots.filter((t) => t != e);
		},
		pub(e, t, r, i, a, o, s) {
			for (let c = 0; c < n.plots.length; c++) n.plots[c] != t && n.plots[c].pub(e, t, r, i, a, o, s);
		}
	}, e != null && (no[e] = n)), n;
}
var io = 1, ao = 2;
function oo(e, t, n) {
	let r = e.mode, i = e.series[t], a = r == 2 ? e._data[t] : e._data, o = e.scales, s = e.bbox, c = a[0], l = r == 2 ? a[1] : a[t], u = r == 2 ? o[i.facets[0].scale] : o[e.series[0].scale], d = r == 2 ? o[i.facets[1].scale] : o[i.scale], f = s.left, p = s.top, m = s.width, h = s.height, g = e.valToPosH, _ = e.valToPosV;
	return u.ori == 0 ? n(i, c, l, u, d, g, _, f, p, m, h, go, vo, bo, So, wo) : n(i, c, l, u, d, _, g, p, f, h, m, _o, yo, xo, Co, To);
}
function so(e, t) {
	let n = 0, r = 0, i = Y(e.bands, ri);
	for (let e = 0; e < i.length; e++) {
		let a = i[e];
		a.series[0] == t ? n = a.dir : a.series[1] == t && (a.dir == 1 ? r |= 1 : r |= 2);
	}
	return [n, r == 1 ? -1 : r == 2 ? 1 : r == 3 ? 2 : 0];
}
function co(e, t, n, r, i) {
	let a = e.mode, o = e.series[t], s = a == 2 ? o.facets[1].scale : o.scale, c = e.scales[s];
	return i == -1 ? c.min : i == 1 ? c.max : c.distr == 3 ? c.dir == 1 ? c.min : c.max : 0;
}
function lo(e, t, n, r, i, a) {
	return oo(e, t, (e, t, o, s, c, l, u, d, f, p, m) => {
		let h = e.pxRound, g = s.dir * (s.ori == 0 ? 1 : -1), _ = s.ori == 0 ? vo : yo, v, y;
		g == 1 ? (v = n, y = r) : (v = r, y = n);
		let b = h(l(t[v], s, p, d)), x = h(u(o[v], c, m, f)), S = h(l(t[y], s, p, d)), C = h(u(a == 1 ? c.max : c.min, c, m, f)), w = new Path2D(i);
		return _(w, S, C), _(w, b, C), _(w, b, x), w;
	});
}
function uo(e, t, n, r, i, a) {
	let o = null;
	if (e.length > 0) {
		o = new Path2D();
		let s = t == 0 ? bo : xo, c = n;
		for (let t = 0; t < e.length; t++) {
			let n = e[t];
			if (n[1] > n[0]) {
				let e = n[0] - c;
				e > 0 && s(o, c, r, e, r + a), c = n[1];
			}
		}
		let l = n + i - c;
		l > 0 && s(o, c, r - 5, l, r + a + 10);
	}
	return o;
}
function fo(e, t, n) {
	let r = e[e.length - 1];
	r && r[0] == t ? r[1] = n : e.push([t, n]);
}
function po(e, t, n, r, i, a, o) {
	let s = [], c = e.length;
	for (let l = i == 1 ? n : r; l >= n && l <= r; l += i) if (t[l] === null) {
		let u = l, d = l;
		if (i == 1) for (; ++l <= r && t[l] === null;) d = l;
		else for (; --l >= n && t[l] === null;) d = l;
		let f = a(e[u]), p = d == u ? f : a(e[d]), m = u - i;
		f = o <= 0 && m >= 0 && m < c ? a(e[m]) : f;
		let h = d + i;
		p = o >= 0 && h >= 0 && h < c ? a(e[h]) : p, p >= f && s.push([f, p]);
	}
	return s;
}
function mo(e) {
	return e == 0 ? Ur : e == 1 ? kr : (t) => Xr(t, e);
}
function ho(e) {
	let t = e == 0 ? go : _o, n = e == 0 ? (e, t, n, r, i, a) => {
		e.arcTo(t, n, r, i, a);
	} : (e, t, n, r, i, a) => {
		e.arcTo(n, t, i, r, a);
	}, r = e == 0 ? (e, t, n, r, i) => {
		e.rect(t, n, r, i);
	} : (e, t, n, r, i) => {
		e.rect(n, t, i, r);
	};
	return (e, i, a, o, s, c = 0, l = 0) => {
		c == 0 && l == 0 ? r(e, i, a, o, s) : (c = jr(c, o / 2, s / 2), l = jr(l, o / 2, s / 2), t(e, i + c, a), n(e, i + o, a, i + o, a + s, c), n(e, i + o, a + s, i, a + s, l), n(e, i, a + s, i, a, l), n(e, i, a, i + o, a, c), e.closePath());
	};
}
var go = (e, t, n) => {
	e.moveTo(t, n);
}, _o = (e, t, n) => {
	e.moveTo(n, t);
}, vo = (e, t, n) => {
	e.lineTo(t, n);
}, yo = (e, t, n) => {
	e.lineTo(n, t);
}, bo = ho(0), xo = ho(1), So = (e, t, n, r, i, a) => {
	e.arc(t, n, r, i, a);
}, Co = (e, t, n, r, i, a) => {
	e.arc(n, t, r, i, a);
}, wo = (e, t, n, r, i, a, o) => {
	e.bezierCurveTo(t, n, r, i, a, o);
}, To = (e, t, n, r, i, a, o) => {
	e.bezierCurveTo(n, t, i, r, o, a);
};
function Eo(e) {
	return (e, t, n, r, i) => oo(e, t, (t, a, o, s, c, l, u, d, f, p, m) => {
		let { pxRound: h, points: g } = t, _, v;
		s.ori == 0 ? (_ = go, v = So) : (_ = _o, v = Co);
		let y = Q(g.width * K, 3), b = (g.size - g.width) / 2 * K, x = Q(b * 2, 3), S = new Path2D(), C = new Path2D(), { left: w, top: T, width: E, height: D } = e.bbox;
		bo(C, w - x, T - x, E + x * 2, D + x * 2);
		let O = (e) => {
			if (o[e] != null) {
				let t = h(l(a[e], s, p, d)), n = h(u(o[e], c, m, f));
				_(S, t + b, n), v(S, t, n, b, 0, Er * 2);
			}
		};
		if (i) i.forEach(O);
		else for (let e = n; e <= r; e++) O(e);
		return {
			stroke: y > 0 ? S : null,
			fill: S,
			clip: C,
			flags: 3
		};
	});
}
function Do(e) {
	return (t, n, r, i, a, o) => {
		r != i && (a != r && o != r && e(t, n, r), a != i && o != i && e(t, n, i), e(t, n, o));
	};
}
var Oo = Do(vo), ko = Do(yo);
function Ao(e) {
	let t = Y(e?.alignGaps, 0);
	return (e, n, r, i) => oo(e, n, (a, o, s, c, l, u, d, f, p, m, h) => {
		[r, i] = dr(s, r, i);
		let g = a.pxRound, _ = (e) => g(u(e, c, m, f)), v = (e) => g(d(e, l, h, p)), y, b;
		c.ori == 0 ? (y = vo, b = Oo) : (y = yo, b = ko);
		let x = c.dir * (c.ori == 0 ? 1 : -1), S = {
			stroke: new Path2D(),
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: io
		}, C = S.stroke, w = !1;
		if (i - r >= m * 4) {
			let t = (t) => e.posToVal(t, c.key, !0), n = null, a = null, l, u, d, f = _(o[x == 1 ? r : i]), p = _(o[r]), m = _(o[i]), h = t(x == 1 ? p + 1 : m - 1);
			for (let e = x == 1 ? r : i; e >= r && e <= i; e += x) {
				let r = o[e], i = (x == 1 ? r < h : r > h) ? f : _(r), c = s[e];
				i == f ? c == null ? c === null && (w = !0) : (u = c, n == null ? (y(C, i, v(u)), l = n = a = u) : u < n ? n = u : u > a && (a = u)) : (n != null && b(C, f, v(n), v(a), v(l), v(u)), c == null ? (n = a = null, c === null && (w = !0)) : (u = c, y(C, i, v(u)), n = a = l = u), f = i, h = t(f + x));
			}
			n != null && n != a && d != f && b(C, f, v(n), v(a), v(l), v(u));
		} else for (let e = x == 1 ? r : i; e >= r && e <= i; e += x) {
			let t = s[e];
			t === null ? w = !0 : t != null && y(C, _(o[e]), v(t));
		}
		let [T, E] = so(e, n);
		if (a.fill != null || T != 0) {
			let t = S.fill = new Path2D(C), s = v(a.fillTo(e, n, a.min, a.max, T)), c = _(o[r]), l = _(o[i]);
			x == -1 && ([l, c] = [c, l]), y(t, l, s), y(t, c, s);
		}
		if (!a.spanGaps) {
			let l = [];
			w && l.push(...po(o, s, r, i, x, _, t)), S.gaps = l = a.gaps(e, n, r, i, l), S.clip = uo(l, c.ori, f, p, m, h);
		}
		return E != 0 && (S.band = E == 2 ? [lo(e, n, r, i, C, -1), lo(e, n, r, i, C, 1)] : lo(e, n, r, i, C, E)), S;
	});
}
function jo(e) {
	let t = Y(e.align, 1), n = Y(e.ascDesc, !1), r = Y(e.alignGaps, 0), i = Y(e.extend, !1);
	return (e, a, o, s) => oo(e, a, (c, l, u, d, f, p, m, h, g, _, v) => {
		[o, s] = dr(u, o, s);
		let y = c.pxRound, { left: b, width: x } = e.bbox, S = (e) => y(p(e, d, _, h)), C = (e) => y(m(e, f, v, g)), w = d.ori == 0 ? vo : yo, T = {
			stroke: new Path2D(),
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: io
		}, E = T.stroke, D = d.dir * (d.ori == 0 ? 1 : -1), O = C(u[D == 1 ? o : s]), k = S(l[D == 1 ? o : s]), A = k, j = k;
		i && t == -1 && (j = b, w(E, j, O)), w(E, k, O);
		for (let e = D == 1 ? o : s; e >= o && e <= s; e += D) {
			let n = u[e];
			if (n == null) continue;
			let r = S(l[e]), i = C(n);
			t == 1 ? w(E, r, O) : w(E, A, i), w(E, r, i), O = i, A = r;
		}
		let M = A;
		i && t == 1 && (M = b + x, w(E, M, O));
		let [ee, te] = so(e, a);
		if (c.fill != null || ee != 0) {
			let t = T.fill = new Path2D(E), n = C(c.fillTo(e, a, c.min, c.max, ee));
			w(t, M, n), w(t, j, n);
		}
		if (!c.spanGaps) {
			let i = [];
			i.push(...po(l, u, o, s, D, S, r));
			let f = c.width * K / 2, p = n || t == 1 ? f : -f, m = n || t == -1 ? -f : f;
			i.forEach((e) => {
				e[0] += p, e[1] += m;
			}), T.gaps = i = c.gaps(e, a, o, s, i), T.clip = uo(i, d.ori, h, g, _, v);
		}
		return te != 0 && (T.band = te == 2 ? [lo(e, a, o, s, E, -1), lo(e, a, o, s, E, 1)] : lo(e, a, o, s, E, te)), T;
	});
}
function Mo(e, t, n, r, i, a, o = X) {
	if (e.length > 1) {
		let s = null;
		for (let c = 0, l = Infinity; c < e.length; c++) if (t[c] !== void 0) {
			if (s != null) {
				let t = Dr(e[c] - e[s]);
				t < l && (l = t, o = Dr(n(e[c], r, i, a) - n(e[s], r, i, a)));
			}
			s = c;
		}
	}
	return o;
}
function No(e) {
	e ||= ni;
	let t = Y(e.size, [
		.6,
		X,
		1
	]), n = e.align || 0, r = e.gap || 0, i = e.radius;
	i = i == null ? [0, 0] : typeof i == "number" ? [i, 0] : i;
	let a = Z(i), o = 1 - t[0], s = Y(t[1], X), c = Y(t[2], 1), l = Y(e.disp, ni), u = Y(e.each, (e) => {}), { fill: d, stroke: f } = l;
	return (e, t, i, p) => oo(e, t, (m, h, g, _, v, y, b, x, S, C, w) => {
		let T = m.pxRound, E = n, D = r * K, O = s * K, k = c * K, A, j;
		_.ori == 0 ? [A, j] = a(e, t) : [j, A] = a(e, t);
		let M = _.dir * (_.ori == 0 ? 1 : -1), ee = _.ori == 0 ? bo : xo, te = _.ori == 0 ? u : (e, t, n, r, i, a, o) => {
			u(e, t, n, i, r, o, a);
		}, ne = Y(e.bands, ri).find((e) => e.series[0] == t), re = ne == null ? 0 : ne.dir, ie = m.fillTo(e, t, m.min, m.max, re), N = T(b(ie, v, w, S)), P, F, ae, I = C, L = T(m.width * K), oe = !1, se = null, ce = null, le = null, ue = null;
		d != null && (L == 0 || f != null) && (oe = !0, se = d.values(e, t, i, p), ce = /* @__PURE__ */ new Map(), new Set(se).forEach((e) => {
			e != null && ce.set(e, new Path2D());
		}), L > 0 && (le = f.values(e, t, i, p), ue = /* @__PURE__ */ new Map(), new Set(le).forEach((e) => {
			e != null && ue.set(e, new Path2D());
		})));
		let { x0: de, size: fe } = l;
		if (de != null && fe != null) {
			E = 1, h = de.values(e, t, i, p), de.unit == 2 && (h = h.map((t) => e.posToVal(x + t * C, _.key, !0)));
			let n = fe.values(e, t, i, p);
			F = fe.unit == 2 ? n[0] * C : y(n[0], _, C, x) - y(0, _, C, x), I = Mo(h, g, y, _, C, x, I), ae = I - F + D;
		} else I = Mo(h, g, y, _, C, x, I), ae = I * o + D, F = I - ae;
		ae < 1 && (ae = 0), L >= F / 2 && (L = 0), ae < 5 && (T = Ur);
		let pe = ae > 0, me = I - ae - (pe ? L : 0);
		F = T(Br(me, k, O)), P = (E == 0 ? F / 2 : E == M ? 0 : F) - E * M * ((E == 0 ? D / 2 : 0) + (pe ? L / 2 : 0));
		let he = {
			stroke: null,
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: 0
		}, ge = oe ? null : new Path2D(), _e = null;
		if (ne != null) _e = e.data[ne.series[1]];
		else {
			let { y0: n, y1: r } = l;
			n != null && r != null && (g = r.values(e, t, i, p), _e = n.values(e, t, i, p));
		}
		let ve = A * F, ye = j * F;
		for (let n = M == 1 ? i : p; n >= i && n <= p; n += M) {
			let r = g[n];
			if (r == null) continue;
			if (_e != null) {
				let e = _e[n] ?? 0;
				if (r - e == 0) continue;
				N = b(e, v, w, S);
			}
			let i = y(_.distr != 2 || l != null ? h[n] : n, _, C, x), a = b(Y(r, ie), v, w, S), o = T(i - P), s = T(Mr(a, N)), c = T(jr(a, N)), u = s - c;
			if (r != null) {
				let i = r < 0 ? ye : ve, a = r < 0 ? ve : ye;
				oe ? (L > 0 && le[n] != null && ee(ue.get(le[n]), o, c + Or(L / 2), F, Mr(0, u - L), i, a), se[n] != null && ee(ce.get(se[n]), o, c + Or(L / 2), F, Mr(0, u - L), i, a)) : ee(ge, o, c + Or(L / 2), F, Mr(0, u - L), i, a), te(e, t, n, o - L / 2, c, F + L, u);
			}
		}
		return L > 0 ? he.stroke = oe ? ue : ge : oe || (he._fill = m.width == 0 ? m._fill : m._stroke ?? m._fill, he.width = 0), he.fill = oe ? ce : ge, he;
	});
}
function Po(e, t) {
	let n = Y(t?.alignGaps, 0);
	return (t, r, i, a) => oo(t, r, (o, s, c, l, u, d, f, p, m, h, g) => {
		[i, a] = dr(c, i, a);
		let _ = o.pxRound, v = (e) => _(d(e, l, h, p)), y = (e) => _(f(e, u, g, m)), b, x, S;
		l.ori == 0 ? (b = go, S = vo, x = wo) : (b = _o, S = yo, x = To);
		let C = l.dir * (l.ori == 0 ? 1 : -1), w = v(s[C == 1 ? i : a]), T = w, E = [], D = [];
		for (let e = C == 1 ? i : a; e >= i && e <= a; e += C) if (c[e] != null) {
			let t = s[e], n = v(t);
			E.push(T = n), D.push(y(c[e]));
		}
		let O = {
			stroke: e(E, D, b, S, x, _),
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: io
		}, k = O.stroke, [A, j] = so(t, r);
		if (o.fill != null || A != 0) {
			let e = O.fill = new Path2D(k), n = y(o.fillTo(t, r, o.min, o.max, A));
			S(e, T, n), S(e, w, n);
		}
		if (!o.spanGaps) {
			let e = [];
			e.push(...po(s, c, i, a, C, v, n)), O.gaps = e = o.gaps(t, r, i, a, e), O.clip = uo(e, l.ori, p, m, h, g);
		}
		return j != 0 && (O.band = j == 2 ? [lo(t, r, i, a, k, -1), lo(t, r, i, a, k, 1)] : lo(t, r, i, a, k, j)), O;
	});
}
function Fo(e) {
	return Po(Io, e);
}
function Io(e, t, n, r, i, a) {
	let o = e.length;
	if (o < 2) return null;
	let s = new Path2D();
	if (n(s, e[0], t[0]), o == 2) r(s, e[1], t[1]);
	else {
		let n = Array(o), r = Array(o - 1), a = Array(o - 1), c = Array(o - 1);
		for (let n = 0; n < o - 1; n++) a[n] = t[n + 1] - t[n], c[n] = e[n + 1] - e[n], r[n] = a[n] / c[n];
		n[0] = r[0];
		for (let e = 1; e < o - 1; e++) r[e] === 0 || r[e - 1] === 0 || r[e - 1] > 0 != r[e] > 0 ? n[e] = 0 : (n[e] = 3 * (c[e - 1] + c[e]) / ((2 * c[e] + c[e - 1]) / r[e - 1] + (c[e] + 2 * c[e - 1]) / r[e]), isFinite(n[e]) || (n[e] = 0));
		n[o - 1] = r[o - 2];
		for (let r = 0; r < o - 1; r++) i(s, e[r] + c[r] / 3, t[r] + n[r] * c[r] / 3, e[r + 1] - c[r] / 3, t[r + 1] - n[r + 1] * c[r] / 3, e[r + 1], t[r + 1]);
	}
	return s;
}
var Lo = /* @__PURE__ */ new Set();
function Ro() {
	for (let e of Lo) e.syncRect(!0);
}
G && (ar(W, Wn, Ro), ar(zn, Wn, Ro, !0), ar(Vn, Wn, () => {
	es.pxRatio = K;
}));
var zo = Ao(), Bo = Eo();
function Vo(e, t, n, r) {
	return (r ? [e[0], e[1]].concat(e.slice(2)) : [e[0]].concat(e.slice(1))).map((e, r) => Uo(e, r, t, n));
}
function Ho(e, t) {
	return e.map((e, n) => n == 0 ? {} : mi({}, t, e));
}
function Uo(e, t, n, r) {
	return mi({}, t == 0 ? n : r, e);
}
function Wo(e, t, n) {
	return t == null ? ii : [t, n];
}
var Go = Wo;
function Ko(e, t, n) {
	return t == null ? ii : br(t, n, gr, !0);
}
function qo(e, t, n, r) {
	return t == null ? ii : mr(t, n, e.scales[r].log, !1);
}
var Jo = qo;
function Yo(e, t, n, r) {
	return t == null ? ii : hr(t, n, e.scales[r].log, !1);
}
var Xo = Yo;
function Zo(e, t, n, r, i) {
	let a = Mr(zr(e), zr(t)), o = t - e, s = sr(i / r * o, n);
	do {
		let e = n[s], t = r * e / o;
		if (t >= i && a + (e < 5 ? $r.get(e) : 0) <= 17) return [e, t];
	} while (++s < n.length);
	return [0, 0];
}
function Qo(e) {
	let t, n;
	return e = e.replace(/(\d+)px/, (e, r) => (t = kr((n = +r) * K)) + "px"), [
		e,
		t,
		n
	];
}
function $o(e) {
	e.show && [e.font, e.labelFont].forEach((e) => {
		let t = Q(e[2] * K, 1);
		e[0] = e[0].replace(/[0-9.]+px/, t + "px"), e[1] = t;
	});
}
function es(e, t, n) {
	let r = { mode: Y(e.mode, 1) }, i = r.mode;
	function a(e, t, n, r) {
		let i = t.valToPct(e);
		return r + n * (t.dir == -1 ? 1 - i : i);
	}
	function o(e, t, n, r) {
		let i = t.valToPct(e);
		return r + n * (t.dir == -1 ? i : 1 - i);
	}
	function s(e, t, n, r) {
		return t.ori == 0 ? a(e, t, n, r) : o(e, t, n, r);
	}
	r.valToPosH = a, r.valToPosV = o;
	let c = !1;
	r.status = 0;
	let l = r.root = Xn(on);
	if (e.id != null && (l.id = e.id), qn(l, e.class), e.title) {
		let t = Xn(ln, l);
		t.textContent = e.title;
	}
	let u = Yn("canvas"), d = r.ctx = u.getContext("2d"), f = Xn(un, l);
	ar("click", f, (e) => {
		e.target === m && (U != tn || W != nn) && Bn.click(r, e);
	}, !0);
	let p = r.under = Xn(dn, f);
	f.appendChild(u);
	let m = r.over = Xn(fn, f);
	e = pi(e);
	let h = +Y(e.pxAlign, 1), g = mo(h);
	(e.plugins || []).forEach((t) => {
		t.opts && (e = t.opts(r, e) || e);
	});
	let _ = e.ms || .001, v = r.series = i == 1 ? Vo(e.series || [], Na, Qa, !1) : Ho(e.series || [null], Za), y = r.axes = Vo(e.axes || [], Aa, Ka, !0), b = r.scales = {}, x = r.bands = e.bands || [];
	x.forEach((e) => {
		e.fill = Z(e.fill || null), e.dir = Y(e.dir, -1);
	});
	let S = i == 2 ? v[1].facets[0].scale : v[0].scale, C = {
		axes: zt,
		series: Ot
	}, w = (e.drawOrder || ["axes", "series"]).map((e) => C[e]);
	function T(e) {
		let t = e.distr == 3 ? (t) => Fr(t > 0 ? t : e.clamp(r, t, e.min, e.max, e.key)) : e.distr == 4 ? (t) => Rr(t, e.asinh) : e.distr == 100 ? (t) => e.fwd(t) : (e) => e;
		return (n) => {
			let r = t(n), { _min: i, _max: a } = e, o = a - i;
			return (r - i) / o;
		};
	}
	function E(t) {
		let n = b[t];
		if (n == null) {
			let r = (e.scales || ni)[t] || ni;
			if (r.from != null) {
				E(r.from);
				let e = mi({}, b[r.from], r, { key: t });
				e.valToPct = T(e), b[t] = e;
			} else {
				n = b[t] = mi({}, t == S ? eo : to, r), n.key = t;
				let e = n.time, a = n.range, o = ai(a);
				if ((t != S || i == 2 && !e) && (o && (a[0] == null || a[1] == null) && (a = {
					min: a[0] == null ? _r : {
						mode: 1,
						hard: a[0],
						soft: a[0]
					},
					max: a[1] == null ? _r : {
						mode: 1,
						hard: a[1],
						soft: a[1]
					}
				}, o = !1), !o && li(a))) {
					let e = a;
					a = (t, n, r) => n == null ? ii : br(n, r, e);
				}
				n.range = Z(a || (e ? Go : t == S ? n.distr == 3 ? Jo : n.distr == 4 ? Xo : Wo : n.distr == 3 ? qo : n.distr == 4 ? Yo : Ko)), n.auto = Z(!o && n.auto), n.clamp = Z(n.clamp || $a), n._min = n._max = null, n.valToPct = T(n);
			}
		}
	}
	E("x"), E("y"), i == 1 && v.forEach((e) => {
		E(e.scale);
	}), y.forEach((e) => {
		E(e.scale);
	});
	for (let t in e.scales) E(t);
	let D = b[S], O = D.distr, k, A;
	D.ori == 0 ? (qn(l, sn), k = a, A = o) : (qn(l, cn), k = o, A = a);
	let j = {};
	for (let e in b) {
		let t = b[e];
		(t.min != null || t.max != null) && (j[e] = {
			min: t.min,
			max: t.max
		}, t.min = t.max = null);
	}
	let M = e.tzDate || ((e) => new Date(kr(e / _))), ee = e.fmtDate || Mi, te = _ == 1 ? ea(M) : ra(M), ne = aa(M, ia(_ == 1 ? $i : na, ee)), re = ua(M, ca(la, ee)), ie = [], N = r.legend = mi({}, pa, e.legend), P = r.cursor = mi({}, Sa, { drag: { y: i == 2 } }, e.cursor), F = N.show, ae = P.show, I = N.markers;
	N.idxs = ie, I.width = Z(I.width), I.dash = Z(I.dash), I.stroke = Z(I.stroke), I.fill = Z(I.fill);
	let L, oe, se, ce = [], le = [], ue, de = !1, fe = {};
	if (N.live) {
		let e = v[1] ? v[1].values : null;
		de = e != null, ue = de ? e(r, 1, 0) : { _: 0 };
		for (let e in ue) fe[e] = Hn;
	}
	if (F) {
		if (L = Yn("table", yn, l), se = Yn("tbody", null, L), N.mount(r, L), de) {
			oe = Yn("thead", null, L, se);
			let e = Yn("tr", null, oe);
			for (var pe in Yn("th", null, e), ue) Yn("th", wn, e).textContent = pe;
		} else qn(L, xn), N.live && qn(L, bn);
	}
	let me = { show: !0 }, he = { show: !1 };
	function ge(e, t) {
		if (t == 0 && (de || !N.live || i == 2)) return ii;
		let n = [], a = Yn("tr", Sn, se, se.childNodes[t]);
		qn(a, e.class), e.show || qn(a, mn);
		let o = Yn("th", null, a);
		if (I.show) {
			let e = Xn(Cn, o);
			if (t > 0) {
				let n = I.width(r, t);
				n && (e.style.border = n + "px " + I.dash(r, t) + " " + I.stroke(r, t)), e.style.background = I.fill(r, t);
			}
		}
		let s = Xn(wn, o);
		for (var c in e.label instanceof HTMLElement ? s.appendChild(e.label) : s.textContent = e.label, t > 0 && (I.show || (s.style.color = e.width > 0 ? I.stroke(r, t) : I.fill(r, t)), ve("click", o, (t) => {
			if (P._lock) return;
			Ue(t);
			let n = v.indexOf(e);
			if ((t.ctrlKey || t.metaKey) != N.isolate) {
				let e = v.some((e, t) => t > 0 && t != n && e.show);
				v.forEach((t, r) => {
					r > 0 && rr(r, e ? r == n ? me : he : me, !0, Oi.setSeries);
				});
			} else rr(n, { show: !e.show }, !0, Oi.setSeries);
		}, !1), Ke && ve(In, o, (t) => {
			P._lock || (Ue(t), rr(v.indexOf(e), yr, !0, Oi.setSeries));
		}, !1)), ue) {
			let e = Yn("td", Tn, a);
			e.textContent = "--", n.push(e);
		}
		return [a, n];
	}
	let _e = /* @__PURE__ */ new Map();
	function ve(e, t, n, i = !0) {
		let a = _e.get(t) || {}, o = P.bind[e](r, t, n, i);
		o && (ar(e, t, a[e] = o), _e.set(t, a));
	}
	function ye(e, t, n) {
		let r = _e.get(t) || {};
		for (let n in r) (e == null || n == e) && (or(n, t, r[n]), delete r[n]);
		e ?? _e.delete(t);
	}
	let be = 0, R = 0, z = 0, B = 0, xe = 0, Se = 0, Ce = xe, we = Se, Te = z, Ee = B, De = 0, Oe = 0, ke = 0, Ae = 0;
	r.bbox = {};
	let je = !1, Me = !1, Ne = !1, Pe = !1, Fe = !1, Ie = !1;
	function Le(e, t, n) {
		(n || e != r.width || t != r.height) && Re(e, t), Bt(!1), Ne = !0, Me = !0, Gt();
	}
	function Re(e, t) {
		r.width = be = z = e, r.height = R = B = t, xe = Se = 0, Ve(), He();
		let n = r.bbox;
		De = n.left = Xr(xe * K, .5), Oe = n.top = Xr(Se * K, .5), ke = n.width = Xr(z * K, .5), Ae = n.height = Xr(B * K, .5);
	}
	function ze() {
		let e = !1, t = 0;
		for (; !e;) {
			t++;
			let n = Lt(t), i = Rt(t);
			e = t == 3 || n && i, e || (Re(r.width, r.height), Me = !0);
		}
	}
	function Be({ width: e, height: t }) {
		Le(e, t);
	}
	r.setSize = Be;
	function Ve() {
		let e = !1, t = !1, n = !1, r = !1;
		y.forEach((i, a) => {
			if (i.show && i._show) {
				let { side: a, _size: o } = i, s = a % 2, c = o + (i.label == null ? 0 : i.labelSize);
				c > 0 && (s ? (z -= c, a == 3 ? (xe += c, r = !0) : n = !0) : (B -= c, a == 0 ? (Se += c, e = !0) : t = !0));
			}
		}), et[0] = e, et[1] = n, et[2] = t, et[3] = r, z -= rt[1] + rt[3], xe += rt[3], B -= rt[2] + rt[0], Se += rt[0];
	}
	function He() {
		let e = xe + z, t = Se + B, n = xe, r = Se;
		function i(i, a) {
			switch (i) {
				case 1: return e += a, e - a;
				case 2: return t += a, t - a;
				case 3: return n -= a, n + a;
				case 0: return r -= a, r + a;
			}
		}
		y.forEach((e, t) => {
			if (e.show && e._show) {
				let t = e.side;
				e._pos = i(t, e._size), e.label != null && (e._lpos = i(t, e.labelSize));
			}
		});
	}
	if (P.dataIdx == null) {
		let e = P.hover, n = e.skip = new Set(e.skip ?? []);
		n.add(void 0);
		let r = e.prox = Z(e.prox), i = e.bias ??= 0;
		P.dataIdx = (e, a, o, s) => {
			if (a == 0) return o;
			let c = o, l = r(e, a, o, s) ?? X, u = l >= 0 && l < X, d = D.ori == 0 ? z : B, f = P.left, p = t[0], m = t[a];
			if (n.has(m[o])) {
				c = null;
				let e = null, t = null, r;
				if (i == 0 || i == -1) for (r = o; e == null && r-- > 0;) n.has(m[r]) || (e = r);
				if (i == 0 || i == 1) for (r = o; t == null && r++ < m.length;) n.has(m[r]) || (t = r);
				if (e != null || t != null) {
					if (u) {
						let n = e == null ? -Infinity : k(p[e], D, d, 0), r = t == null ? Infinity : k(p[t], D, d, 0), i = f - n, a = r - f;
						i <= a ? i <= l && (c = e) : a <= l && (c = t);
					} else c = t == null ? e : e == null ? t : o - e <= t - o ? e : t;
				}
			} else u && Dr(f - k(p[o], D, d, 0)) > l && (c = null);
			return c;
		};
	}
	let Ue = (e) => {
		P.event = e;
	};
	P.idxs = ie, P._lock = !1;
	let We = P.points;
	We.show = Z(We.show), We.size = Z(We.size), We.stroke = Z(We.stroke), We.width = Z(We.width), We.fill = Z(We.fill);
	let Ge = r.focus = mi({}, e.focus || { alpha: .3 }, P.focus), Ke = Ge.prox >= 0, qe = Ke && We.one, Je = [], Ye = [], V = [];
	function Xe(e, t) {
		let n = We.show(r, t);
		if (n instanceof HTMLElement) return qn(n, vn), qn(n, e.class), Qn(n, -10, -10, z, B), m.insertBefore(n, Je[t]), n;
	}
	function Ze(e, t) {
		if (i == 1 || t > 0) {
			let t = i == 1 && b[e.scale].time, n = e.value;
			e.value = t ? ci(n) ? ua(M, ca(n, ee)) : n || re : n || Ga, e.label = e.label || (t ? Ma : ja);
		}
		if (qe || t > 0) {
			e.width = e.width == null ? 1 : e.width, e.paths = e.paths || zo || Gr, e.fillTo = Z(e.fillTo || co), e.pxAlign = +Y(e.pxAlign, h), e.pxRound = mo(e.pxAlign), e.stroke = Z(e.stroke || null), e.fill = Z(e.fill || null), e._stroke = e._fill = e._paths = e._focus = null;
			let t = qa(Mr(1, e.width), 1), n = e.points = mi({}, {
				size: t,
				width: Mr(1, t * .2),
				stroke: e.stroke,
				space: t * 2,
				paths: Bo,
				_stroke: null,
				_fill: null
			}, e.points);
			n.show = Z(n.show), n.filter = Z(n.filter), n.fill = Z(n.fill), n.stroke = Z(n.stroke), n.paths = Z(n.paths), n.pxAlign = e.pxAlign;
		}
		if (F) {
			let n = ge(e, t);
			ce.splice(t, 0, n[0]), le.splice(t, 0, n[1]), N.values.push(null);
		}
		if (ae) {
			ie.splice(t, 0, null);
			let n = null;
			qe ? t == 0 && (n = Xe(e, t)) : t > 0 && (n = Xe(e, t)), Je.splice(t, 0, n), Ye.splice(t, 0, 0), V.splice(t, 0, 0);
		}
		Ei("addSeries", t);
	}
	function Qe(e, t) {
		t ??= v.length, e = i == 1 ? Uo(e, t, Na, Qa) : Uo(e, t, {}, Za), v.splice(t, 0, e), Ze(v[t], t);
	}
	r.addSeries = Qe;
	function $e(e) {
		if (v.splice(e, 1), F) {
			N.values.splice(e, 1), le.splice(e, 1);
			let t = ce.splice(e, 1)[0];
			ye(null, t.firstChild), t.remove();
		}
		ae && (ie.splice(e, 1), Je.splice(e, 1)[0].remove(), Ye.splice(e, 1), V.splice(e, 1)), Ei("delSeries", e);
	}
	r.delSeries = $e;
	let et = [
		!1,
		!1,
		!1,
		!1
	];
	function tt(e, t) {
		if (e._show = e.show, e.show) {
			let n = e.side % 2, i = b[e.scale];
			i ??= (e.scale = n ? v[1].scale : S, b[e.scale]);
			let a = i.time;
			e.size = Z(e.size), e.space = Z(e.space), e.rotate = Z(e.rotate), ai(e.incrs) && e.incrs.forEach((e) => {
				!$r.has(e) && $r.set(e, ei(e));
			}), e.incrs = Z(e.incrs || (i.distr == 2 ? zi : a ? _ == 1 ? Qi : ta : Bi)), e.splits = Z(e.splits || (a && i.distr == 1 ? te : i.distr == 3 ? Ia : i.distr == 4 ? La : Fa)), e.stroke = Z(e.stroke), e.grid.stroke = Z(e.grid.stroke), e.ticks.stroke = Z(e.ticks.stroke), e.border.stroke = Z(e.border.stroke);
			let o = e.values;
			e.values = ai(o) && !ai(o[0]) ? Z(o) : a ? ai(o) ? aa(M, ia(o, ee)) : ci(o) ? oa(M, o) : o || ne : o || Pa, e.filter = Z(e.filter || (i.distr >= 3 && i.log == 10 ? Ua : i.distr == 3 && i.log == 2 ? Wa : Wr)), e.font = Qo(e.font), e.labelFont = Qo(e.labelFont), e._size = e.size(r, null, t, 0), e._space = e._rotate = e._incrs = e._found = e._splits = e._values = null, e._size > 0 && (et[t] = !0, e._el = Xn(pn, f));
		}
	}
	function H(e, t, n, r) {
		let [i, a, o, s] = n, c = t % 2, l = 0;
		return c == 0 && (s || a) && (l = t == 0 && !i || t == 2 && !o ? kr(Aa.size / 3) : 0), c == 1 && (i || o) && (l = t == 1 && !a || t == 3 && !s ? kr(Ka.size / 2) : 0), l;
	}
	let nt = r.padding = (e.padding || [
		H,
		H,
		H,
		H
	]).map((e) => Z(Y(e, H))), rt = r._padding = nt.map((e, t) => e(r, t, et, 0)), it, at = null, ot = null, st = i == 1 ? v[0].idxs : null, ct = null, lt = !1;
	function ut(e, n) {
		if (t = e ?? [], r.data = r._data = t, i == 2) {
			it = 0;
			for (let e = 1; e < v.length; e++) it += t[e][0].length;
		} else {
			t.length == 0 && (r.data = r._data = t = [[]]), ct = t[0], it = ct.length;
			let e = t;
			if (O == 2) {
				e = t.slice();
				let n = e[0] = Array(it);
				for (let e = 0; e < it; e++) n[e] = e;
			}
			r._data = t = e;
		}
		if (Bt(!0), Ei("setData"), O == 2 && (Ne = !0), n !== !1) {
			let e = D;
			e.auto(r, lt) ? dt() : tr(S, e.min, e.max), Pe ||= P.left >= 0, Ie = !0, Gt();
		}
	}
	r.setData = ut;
	function dt() {
		lt = !0;
		let e, n;
		i == 1 && (it > 0 ? (at = st[0] = 0, ot = st[1] = it - 1, e = t[0][at], n = t[0][ot], O == 2 ? (e = at, n = ot) : e == n && (O == 3 ? [e, n] = mr(e, e, D.log, !1) : O == 4 ? [e, n] = hr(e, e, D.log, !1) : D.time ? n = e + kr(86400 / _) : [e, n] = br(e, n, gr, !0))) : (at = st[0] = e = null, ot = st[1] = n = null)), tr(S, e, n);
	}
	let ft, pt, mt, ht, gt, _t, vt, yt, bt, xt;
	function St(e, t, n, r, i, a) {
		e ??= Mn, n ??= ri, r ??= "butt", i ??= Mn, a ??= "round", e != ft && (d.strokeStyle = ft = e), i != pt && (d.fillStyle = pt = i), t != mt && (d.lineWidth = mt = t), a != gt && (d.lineJoin = gt = a), r != _t && (d.lineCap = _t = r), n != ht && d.setLineDash(ht = n);
	}
	function Ct(e, t, n, r) {
		t != pt && (d.fillStyle = pt = t), e != vt && (d.font = vt = e), n != yt && (d.textAlign = yt = n), r != bt && (d.textBaseline = bt = r);
	}
	function wt(e, t, n, i, a = 0) {
		if (i.length > 0 && e.auto(r, lt) && (t == null || t.min == null)) {
			let t = Y(at, 0), r = Y(ot, i.length - 1), o = n.min == null ? pr(i, t, r, a, e.distr == 3) : [n.min, n.max];
			e.min = jr(e.min, n.min = o[0]), e.max = Mr(e.max, n.max = o[1]);
		}
	}
	let Tt = {
		min: null,
		max: null
	};
	function Et() {
		for (let e in b) {
			let t = b[e];
			j[e] == null && (t.min == null || j[S] != null && t.auto(r, lt)) && (j[e] = Tt);
		}
		for (let e in b) {
			let t = b[e];
			j[e] == null && t.from != null && j[t.from] != null && (j[e] = Tt);
		}
		j[S] != null && Bt(!0);
		let e = {};
		for (let t in j) {
			let n = j[t];
			if (n != null) {
				let a = e[t] = pi(b[t], ui);
				if (n.min != null) mi(a, n);
				else if (t != S || i == 2) {
					if (it == 0 && a.from == null) {
						let e = a.range(r, null, null, t);
						a.min = e[0], a.max = e[1];
					} else a.min = X, a.max = -Infinity;
				}
			}
		}
		if (it > 0) {
			v.forEach((n, a) => {
				if (i == 1) {
					let i = n.scale, o = j[i];
					if (o == null) return;
					let s = e[i];
					if (a == 0) {
						let e = s.range(r, s.min, s.max, i);
						s.min = e[0], s.max = e[1], at = sr(s.min, t[0]), ot = sr(s.max, t[0]), ot - at > 1 && (t[0][at] < s.min && at++, t[0][ot] > s.max && ot--), n.min = ct[at], n.max = ct[ot];
					} else n.show && n.auto && wt(s, o, n, t[a], n.sorted);
					n.idxs[0] = at, n.idxs[1] = ot;
				} else if (a > 0 && n.show && n.auto) {
					let [r, i] = n.facets, o = r.scale, s = i.scale, [c, l] = t[a], u = e[o], d = e[s];
					u != null && wt(u, j[o], r, c, r.sorted), d != null && wt(d, j[s], i, l, i.sorted), n.min = i.min, n.max = i.max;
				}
			});
			for (let t in e) {
				let n = e[t], i = j[t];
				if (n.from == null && (i == null || i.min == null)) {
					let e = n.range(r, n.min == X ? null : n.min, n.max == -Infinity ? null : n.max, t);
					n.min = e[0], n.max = e[1];
				}
			}
		}
		for (let t in e) {
			let n = e[t];
			if (n.from != null) {
				let i = e[n.from];
				if (i.min == null) n.min = n.max = null;
				else {
					let e = n.range(r, i.min, i.max, t);
					n.min = e[0], n.max = e[1];
				}
			}
		}
		let n = {}, a = !1;
		for (let t in e) {
			let r = e[t], i = b[t];
			if (i.min != r.min || i.max != r.max) {
				i.min = r.min, i.max = r.max;
				let e = i.distr;
				i._min = e == 3 ? Fr(i.min) : e == 4 ? Rr(i.min, i.asinh) : e == 100 ? i.fwd(i.min) : i.min, i._max = e == 3 ? Fr(i.max) : e == 4 ? Rr(i.max, i.asinh) : e == 100 ? i.fwd(i.max) : i.max, n[t] = a = !0;
			}
		}
		if (a) {
			v.forEach((e, t) => {
				i == 2 ? t > 0 && n.y && (e._paths = null) : n[e.scale] && (e._paths = null);
			});
			for (let e in n) Ne = !0, Ei("setScale", e);
			ae && P.left >= 0 && (Pe = Ie = !0);
		}
		for (let e in j) j[e] = null;
	}
	function Dt(e) {
		let t = Br(at - 1, 0, it - 1), n = Br(ot + 1, 0, it - 1);
		for (; e[t] == null && t > 0;) t--;
		for (; e[n] == null && n < it - 1;) n++;
		return [t, n];
	}
	function Ot() {
		if (it > 0) {
			let e = v.some((e) => e._focus) && xt != Ge.alpha;
			e && (d.globalAlpha = xt = Ge.alpha), v.forEach((e, n) => {
				if (n > 0 && e.show && (kt(n, !1), kt(n, !0), e._paths == null)) {
					let a = xt;
					xt != e.alpha && (d.globalAlpha = xt = e.alpha);
					let o = i == 2 ? [0, t[n][0].length - 1] : Dt(t[n]);
					e._paths = e.paths(r, n, o[0], o[1]), xt != a && (d.globalAlpha = xt = a);
				}
			}), v.forEach((e, t) => {
				if (t > 0 && e.show) {
					let n = xt;
					xt != e.alpha && (d.globalAlpha = xt = e.alpha), e._paths != null && At(t, !1);
					{
						let n = e._paths == null ? null : e._paths.gaps, i = e.points.show(r, t, at, ot, n), a = e.points.filter(r, t, i, n);
						(i || a) && (e.points._paths = e.points.paths(r, t, at, ot, a), At(t, !0));
					}
					xt != n && (d.globalAlpha = xt = n), Ei("drawSeries", t);
				}
			}), e && (d.globalAlpha = xt = 1);
		}
	}
	function kt(e, t) {
		let n = t ? v[e].points : v[e];
		n._stroke = n.stroke(r, e), n._fill = n.fill(r, e);
	}
	function At(e, t) {
		let n = t ? v[e].points : v[e], { stroke: r, fill: i, clip: a, flags: o, _stroke: s = n._stroke, _fill: c = n._fill, _width: l = n.width } = n._paths;
		l = Q(l * K, 3);
		let u = null, f = l % 2 / 2;
		t && c == null && (c = l > 0 ? "#fff" : s);
		let p = n.pxAlign == 1 && f > 0;
		if (p && d.translate(f, f), !t) {
			let e = De - l / 2, t = Oe - l / 2, n = ke + l, r = Ae + l;
			u = new Path2D(), u.rect(e, t, n, r);
		}
		t ? Mt(s, l, n.dash, n.cap, c, r, i, o, a) : jt(e, s, l, n.dash, n.cap, c, r, i, o, u, a), p && d.translate(-f, -f);
	}
	function jt(e, n, i, a, o, s, c, l, u, d, f) {
		let p = !1;
		u != 0 && x.forEach((m, h) => {
			if (m.series[0] == e) {
				let e = v[m.series[1]], g = t[m.series[1]], _ = (e._paths || ni).band;
				ai(_) && (_ = m.dir == 1 ? _[0] : _[1]);
				let y, b = null;
				e.show && _ && xr(g, at, ot) ? (b = m.fill(r, h) || s, y = e._paths.clip) : _ = null, Mt(n, i, a, o, b, c, l, u, d, f, y, _), p = !0;
			}
		}), p || Mt(n, i, a, o, s, c, l, u, d, f);
	}
	function Mt(e, t, n, r, i, a, o, s, c, l, u, f) {
		St(e, t, n, r, i), (c || l || f) && (d.save(), c && d.clip(c), l && d.clip(l)), f ? (s & 3) == 3 ? (d.clip(f), u && d.clip(u), Pt(i, o), Nt(e, a, t)) : s & ao ? (Pt(i, o), d.clip(f), Nt(e, a, t)) : s & io && (d.save(), d.clip(f), u && d.clip(u), Pt(i, o), d.restore(), Nt(e, a, t)) : (Pt(i, o), Nt(e, a, t)), (c || l || f) && d.restore();
	}
	function Nt(e, t, n) {
		n > 0 && (t instanceof Map ? t.forEach((e, t) => {
			d.strokeStyle = ft = t, d.stroke(e);
		}) : t != null && e && d.stroke(t));
	}
	function Pt(e, t) {
		t instanceof Map ? t.forEach((e, t) => {
			d.fillStyle = pt = t, d.fill(e);
		}) : t != null && e && d.fill(t);
	}
	function Ft(e, t, n, i) {
		let a = y[e], o;
		if (i <= 0) o = [0, 0];
		else {
			let s = a._space = a.space(r, e, t, n, i);
			o = Zo(t, n, a._incrs = a.incrs(r, e, t, n, i, s), i, s);
		}
		return a._found = o;
	}
	function It(e, t, n, r, i, a, o, s, c, l) {
		let u = o % 2 / 2;
		h == 1 && d.translate(u, u), St(s, o, c, l, s), d.beginPath();
		let f, p, m, g, _ = i + (r == 0 || r == 3 ? -a : a);
		n == 0 ? (p = i, g = _) : (f = i, m = _);
		for (let r = 0; r < e.length; r++) t[r] != null && (n == 0 ? f = m = e[r] : p = g = e[r], d.moveTo(f, p), d.lineTo(m, g));
		d.stroke(), h == 1 && d.translate(-u, -u);
	}
	function Lt(e) {
		let t = !0;
		return y.forEach((n, i) => {
			if (!n.show) return;
			let a = b[n.scale];
			if (a.min == null) {
				n._show && (t = !1, n._show = !1, Bt(!1));
				return;
			}
			n._show || (t = !1, n._show = !0, Bt(!1));
			let o = n.side, s = o % 2, { min: c, max: l } = a, [u, d] = Ft(i, c, l, s == 0 ? z : B);
			if (d == 0) return;
			let f = a.distr == 2, p = n._splits = n.splits(r, i, c, l, u, d, f), m = a.distr == 2 ? p.map((e) => ct[e]) : p, h = a.distr == 2 ? ct[p[1]] - ct[p[0]] : u, g = n._values = n.values(r, n.filter(r, m, i, d, h), i, d, h);
			n._rotate = o == 2 ? n.rotate(r, g, i, d) : 0;
			let _ = n._size;
			n._size = Ar(n.size(r, g, i, e)), _ != null && n._size != _ && (t = !1);
		}), t;
	}
	function Rt(e) {
		let t = !0;
		return nt.forEach((n, i) => {
			let a = n(r, i, et, e);
			a != rt[i] && (t = !1), rt[i] = a;
		}), t;
	}
	function zt() {
		for (let e = 0; e < y.length; e++) {
			let t = y[e];
			if (!t.show || !t._show) continue;
			let n = t.side, i = n % 2, a, o, c = t.stroke(r, e), l = n == 0 || n == 3 ? -1 : 1, [u, f] = t._found;
			if (t.label != null) {
				let s = t.labelGap * l, p = kr((t._lpos + s) * K);
				Ct(t.labelFont[0], c, "center", n == 2 ? On : kn), d.save(), i == 1 ? (a = o = 0, d.translate(p, kr(Oe + Ae / 2)), d.rotate((n == 3 ? -Er : Er) / 2)) : (a = kr(De + ke / 2), o = p);
				let m = Vr(t.label) ? t.label(r, e, u, f) : t.label;
				d.fillText(m, a, o), d.restore();
			}
			if (f == 0) continue;
			let p = b[t.scale], m = i == 0 ? ke : Ae, h = i == 0 ? De : Oe, _ = t._splits, v = p.distr == 2 ? _.map((e) => ct[e]) : _, x = p.distr == 2 ? ct[_[1]] - ct[_[0]] : u, S = t.ticks, C = t.border, w = S.show ? S.size : 0, T = kr(w * K), E = kr((t.alignTo == 2 ? t._size - w - t.gap : t.gap) * K), D = t._rotate * -Er / 180, O = g(t._pos * K), k = O + (T + E) * l;
			o = i == 0 ? k : 0, a = i == 1 ? k : 0;
			let A = t.font[0];
			Ct(A, c, t.align == 1 ? An : t.align == 2 ? jn : D > 0 ? An : D < 0 ? jn : i == 0 ? "center" : n == 3 ? jn : An, D || i == 1 ? "middle" : n == 2 ? On : kn);
			let j = t.font[1] * t.lineGap, M = _.map((e) => g(s(e, p, m, h))), ee = t._values;
			for (let e = 0; e < ee.length; e++) {
				let t = ee[e];
				if (t != null) {
					i == 0 ? a = M[e] : o = M[e], t = "" + t;
					let n = t.indexOf("\n") == -1 ? [t] : t.split(/\n/gm);
					for (let e = 0; e < n.length; e++) {
						let t = n[e];
						D ? (d.save(), d.translate(a, o + e * j), d.rotate(D), d.fillText(t, 0, 0), d.restore()) : d.fillText(t, a, o + e * j);
					}
				}
			}
			S.show && It(M, S.filter(r, v, e, f, x), i, n, O, T, Q(S.width * K, 3), S.stroke(r, e), S.dash, S.cap);
			let te = t.grid;
			te.show && It(M, te.filter(r, v, e, f, x), i, i == 0 ? 2 : 1, i == 0 ? Oe : De, i == 0 ? Ae : ke, Q(te.width * K, 3), te.stroke(r, e), te.dash, te.cap), C.show && It([O], [1], +(i == 0), i == 0 ? 1 : 2, i == 1 ? Oe : De, i == 1 ? Ae : ke, Q(C.width * K, 3), C.stroke(r, e), C.dash, C.cap);
		}
		Ei("drawAxes");
	}
	function Bt(e) {
		v.forEach((t, n) => {
			n > 0 && (t._paths = null, e && (i == 1 ? (t.min = null, t.max = null) : t.facets.forEach((e) => {
				e.min = null, e.max = null;
			})));
		});
	}
	let Vt = !1, Ht = !1, Ut = [];
	function Wt() {
		Ht = !1;
		for (let e = 0; e < Ut.length; e++) Ei(...Ut[e]);
		Ut.length = 0;
	}
	function Gt() {
		Vt ||= (bi(qt), !0);
	}
	function Kt(e, t = !1) {
		Vt = !0, Ht = t, e(r), qt(), t && Ut.length > 0 && queueMicrotask(Wt);
	}
	r.batch = Kt;
	function qt() {
		if (je &&= (Et(), !1), Ne &&= (ze(), !1), Me) {
			if (J(p, An, xe), J(p, On, Se), J(p, En, z), J(p, Dn, B), J(m, An, xe), J(m, On, Se), J(m, En, z), J(m, Dn, B), J(f, En, be), J(f, Dn, R), u.width = kr(be * K), u.height = kr(R * K), y.forEach(({ _el: e, _show: t, _size: n, _pos: r, side: i }) => {
				if (e != null) {
					if (t) {
						let t = i === 3 || i === 0 ? n : 0, a = i % 2 == 1;
						J(e, a ? "left" : "top", r - t), J(e, a ? "width" : "height", n), J(e, a ? "top" : "left", a ? Se : xe), J(e, a ? "height" : "width", a ? B : z), Jn(e, mn);
					} else qn(e, mn);
				}
			}), ft = pt = mt = gt = _t = vt = yt = bt = ht = null, xt = 1, Zr(!0), xe != Ce || Se != we || z != Te || B != Ee) {
				Bt(!1);
				let e = z / Te, t = B / Ee;
				if (ae && !Pe && P.left >= 0) {
					P.left *= e, P.top *= t, Zt && Qn(Zt, kr(P.left), 0, z, B), Qt && Qn(Qt, 0, kr(P.top), z, B);
					for (let n = 0; n < Je.length; n++) {
						let r = Je[n];
						r != null && (Ye[n] *= e, V[n] *= t, Qn(r, Ar(Ye[n]), Ar(V[n]), z, B));
					}
				}
				if (q.show && !Fe && q.left >= 0 && q.width > 0) {
					q.left *= e, q.width *= e, q.top *= t, q.height *= t;
					for (let e in oi) J(Kn, e, q[e]);
				}
				Ce = xe, we = Se, Te = z, Ee = B;
			}
			Ei("setSize"), Me = !1;
		}
		be > 0 && R > 0 && (d.clearRect(0, 0, u.width, u.height), Ei("drawClear"), w.forEach((e) => e()), Ei("draw")), q.show && Fe && (Zn(q), Fe = !1), ae && Pe && (Jr(null, !0, !1), Pe = !1), N.show && N.live && Ie && (Hr(), Ie = !1), c || (c = !0, r.status = 1, Ei("ready")), lt = !1, Vt = !1;
	}
	r.redraw = (e, t) => {
		Ne = t || !1, e === !1 ? Gt() : tr(S, D.min, D.max);
	};
	function Jt(e, n) {
		let i = b[e];
		if (i.from == null) {
			if (it == 0) {
				let t = i.range(r, n.min, n.max, e);
				n.min = t[0], n.max = t[1];
			}
			if (n.min > n.max) {
				let e = n.min;
				n.min = n.max, n.max = e;
			}
			if (it > 1 && n.min != null && n.max != null && n.max - n.min < 1e-16) return;
			e == S && i.distr == 2 && it > 0 && (n.min = sr(n.min, t[0]), n.max = sr(n.max, t[0]), n.min == n.max && n.max++), j[e] = n, je = !0, Gt();
		}
	}
	r.setScale = Jt;
	let Yt, Xt, Zt, Qt, $t, en, tn, nn, rn, an, U, W, zn = !1, Bn = P.drag, G = Bn.x, Gn = Bn.y;
	ae && (P.x && (Yt = Xn(gn, m)), P.y && (Xt = Xn(_n, m)), D.ori == 0 ? (Zt = Yt, Qt = Xt) : (Zt = Xt, Qt = Yt), U = P.left, W = P.top);
	let q = r.select = mi({
		show: !0,
		over: !0,
		left: 0,
		width: 0,
		top: 0,
		height: 0
	}, e.select), Kn = q.show ? Xn(hn, q.over ? m : p) : null;
	function Zn(e, t) {
		if (q.show) {
			for (let t in e) q[t] = e[t], t in oi && J(Kn, t, e[t]);
			t !== !1 && Ei("setSelect");
		}
	}
	r.setSelect = Zn;
	function $n(e) {
		if (v[e].show) F && Jn(ce[e], mn);
		else if (F && qn(ce[e], mn), ae) {
			let t = qe ? Je[0] : Je[e];
			t != null && Qn(t, -10, -10, z, B);
		}
	}
	function tr(e, t, n) {
		Jt(e, {
			min: t,
			max: n
		});
	}
	function rr(e, t, n, a) {
		t.focus != null && Sr(e), t.show != null && v.forEach((n, r) => {
			r > 0 && (e == r || e == null) && (n.show = t.show, $n(r), i == 2 ? (tr(n.facets[0].scale, null, null), tr(n.facets[1].scale, null, null)) : tr(n.scale, null, null), Gt());
		}), n !== !1 && Ei("setSeries", e, t), a && ji("setSeries", r, e, t);
	}
	r.setSeries = rr;
	function ir(e, t) {
		mi(x[e], t);
	}
	function cr(e, t) {
		e.fill = Z(e.fill || null), e.dir = Y(e.dir, -1), t ??= x.length, x.splice(t, 0, e);
	}
	function lr(e) {
		e == null ? x.length = 0 : x.splice(e, 1);
	}
	r.addBand = cr, r.setBand = ir, r.delBand = lr;
	function ur(e, t) {
		v[e].alpha = t, ae && Je[e] != null && (Je[e].style.opacity = t), F && ce[e] && (ce[e].style.opacity = t);
	}
	let dr, fr, vr, yr = { focus: !0 };
	function Sr(e) {
		if (e != vr) {
			let t = e == null, n = Ge.alpha != 1;
			v.forEach((r, a) => {
				if (i == 1 || a > 0) {
					let i = t || a == 0 || a == e;
					r._focus = t ? null : i, n && ur(a, i ? 1 : Ge.alpha);
				}
			}), vr = e, n && Gt();
		}
	}
	F && Ke && ve(Ln, L, (e) => {
		P._lock || (Ue(e), vr != null && rr(null, yr, !0, Oi.setSeries));
	});
	function Cr(e, t, n) {
		let r = b[t];
		n && (e = e / K - (r.ori == 1 ? Se : xe));
		let i = z;
		r.ori == 1 && (i = B, e = i - e), r.dir == -1 && (e = i - e);
		let a = r._min, o = r._max, s = e / i, c = a + (o - a) * s, l = r.distr;
		return l == 3 ? Nr(10, c) : l == 4 ? Lr(c, r.asinh) : l == 100 ? r.bwd(c) : c;
	}
	function wr(e, n) {
		return sr(Cr(e, S, n), t[0], at, ot);
	}
	r.valToIdx = (e) => sr(e, t[0]), r.posToIdx = wr, r.posToVal = Cr, r.valToPos = (e, t, n) => b[t].ori == 0 ? a(e, b[t], n ? ke : z, n ? De : 0) : o(e, b[t], n ? Ae : B, n ? Oe : 0), r.setCursor = (e, t, n) => {
		U = e.left, W = e.top, Jr(null, t, n);
	};
	function Tr(e, t) {
		J(Kn, An, q.left = e), J(Kn, En, q.width = t);
	}
	function Or(e, t) {
		J(Kn, On, q.top = e), J(Kn, Dn, q.height = t);
	}
	let Pr = D.ori == 0 ? Tr : Or, Ir = D.ori == 1 ? Tr : Or;
	function zr() {
		if (F && N.live) for (let e = +(i == 2); e < v.length; e++) {
			if (e == 0 && de) continue;
			let t = N.values[e], n = 0;
			for (let r in t) le[e][n++].firstChild.nodeValue = t[r];
		}
	}
	function Hr(e, t) {
		if (e != null && (e.idxs ? e.idxs.forEach((e, t) => {
			ie[t] = e;
		}) : si(e.idx) || ie.fill(e.idx), N.idx = ie[0]), F && N.live) {
			for (let e = 0; e < v.length; e++) (e > 0 || i == 1 && !de) && Ur(e, ie[e]);
			zr();
		}
		Ie = !1, t !== !1 && Ei("setLegend");
	}
	r.setLegend = Hr;
	function Ur(e, n) {
		let i = v[e], a = e == 0 && O == 2 ? ct : t[e], o;
		de ? o = i.values(r, e, n) ?? fe : (o = i.value(r, n == null ? null : a[n], e, n), o = o == null ? fe : { _: o }), N.values[e] = o;
	}
	function Jr(e, n, a) {
		rn = U, an = W, [U, W] = P.move(r, U, W), P.left = U, P.top = W, ae && (Zt && Qn(Zt, kr(U), 0, z, B), Qt && Qn(Qt, 0, kr(W), z, B));
		let o, s = at > ot;
		dr = X, fr = null;
		let c = D.ori == 0 ? z : B, l = D.ori == 1 ? z : B;
		if (U < 0 || it == 0 || s) {
			o = P.idx = null;
			for (let e = 0; e < v.length; e++) {
				let t = Je[e];
				t != null && Qn(t, -10, -10, z, B);
			}
			Ke && rr(null, yr, !0, e == null && Oi.setSeries), N.live && (ie.fill(o), Ie = !0);
		} else {
			let e, n, a;
			i == 1 && (e = D.ori == 0 ? U : W, n = Cr(e, S), o = P.idx = sr(n, t[0], at, ot), a = k(t[0][o], D, c, 0));
			let s = -10, u = -10, d = 0, f = 0, p = !0, m = "", h = "";
			for (let e = +(i == 2); e < v.length; e++) {
				let g = v[e], _ = ie[e], y = _ == null ? null : i == 1 ? t[e][_] : t[e][1][_], x = P.dataIdx(r, e, o, n), S = x == null ? null : i == 1 ? t[e][x] : t[e][1][x];
				if (Ie = Ie || S != y || x != _, ie[e] = x, e > 0 && g.show) {
					let n = x == null ? -10 : x == o ? a : k(i == 1 ? t[0][x] : t[e][0][x], D, c, 0), _ = S == null ? -10 : A(S, i == 1 ? b[g.scale] : b[g.facets[1].scale], l, 0);
					if (Ke && S != null) {
						let t = D.ori == 1 ? U : W, n = Dr(Ge.dist(r, e, x, _, t));
						if (n < dr) {
							let r = Ge.bias;
							if (r != 0) {
								let i = Cr(t, g.scale), a = S >= 0 ? 1 : -1, o = i >= 0 ? 1 : -1;
								o == a && (o == 1 ? r == 1 ? S >= i : S <= i : r == 1 ? S <= i : S >= i) && (dr = n, fr = e);
							} else dr = n, fr = e;
						}
					}
					if (Ie || qe) {
						let t, i;
						D.ori == 0 ? (t = n, i = _) : (t = _, i = n);
						let a, o, c, l, g, v, y = !0, b = We.bbox;
						if (b != null) {
							y = !1;
							let t = b(r, e);
							c = t.left, l = t.top, a = t.width, o = t.height;
						} else c = t, l = i, a = o = We.size(r, e);
						if (v = We.fill(r, e), g = We.stroke(r, e), qe) e == fr && dr <= Ge.prox && (s = c, u = l, d = a, f = o, p = y, m = v, h = g);
						else {
							let t = Je[e];
							t != null && (Ye[e] = c, V[e] = l, nr(t, a, o, y), er(t, v, g), Qn(t, Ar(c), Ar(l), z, B));
						}
					}
				}
			}
			if (qe) {
				let e = Ge.prox;
				if (Ie || (vr == null ? dr <= e : dr > e || fr != vr)) {
					let e = Je[0];
					e != null && (Ye[0] = s, V[0] = u, nr(e, d, f, p), er(e, m, h), Qn(e, Ar(s), Ar(u), z, B));
				}
			}
		}
		if (q.show && zn) {
			if (e != null) {
				let [t, n] = Oi.scales, [r, i] = Oi.match, [a, o] = e.cursor.sync.scales, s = e.cursor.drag;
				if (G = s._x, Gn = s._y, G || Gn) {
					let { left: s, top: u, width: d, height: f } = e.select, p = e.scales[a].ori, m = e.posToVal, h, g, _, v, y, x = t != null && r(t, a), S = n != null && i(n, o);
					x && G ? (p == 0 ? (h = s, g = d) : (h = u, g = f), _ = b[t], v = k(m(h, a), _, c, 0), y = k(m(h + g, a), _, c, 0), Pr(jr(v, y), Dr(y - v))) : Pr(0, c), S && Gn ? (p == 1 ? (h = s, g = d) : (h = u, g = f), _ = b[n], v = A(m(h, o), _, l, 0), y = A(m(h + g, o), _, l, 0), Ir(jr(v, y), Dr(y - v))) : Ir(0, l);
				} else di();
			} else {
				let e = Dr(rn - $t), t = Dr(an - en);
				if (D.ori == 1) {
					let n = e;
					e = t, t = n;
				}
				G = Bn.x && e >= Bn.dist, Gn = Bn.y && t >= Bn.dist;
				let n = Bn.uni;
				n == null ? Bn.x && Bn.y && (G || Gn) && (G = Gn = !0) : G && Gn && (G = e >= n, Gn = t >= n, !G && !Gn && (t > e ? Gn = !0 : G = !0));
				let r, i;
				G && (D.ori == 0 ? (r = tn, i = U) : (r = nn, i = W), Pr(jr(r, i), Dr(i - r)), Gn || Ir(0, l)), Gn && (D.ori == 1 ? (r = tn, i = U) : (r = nn, i = W), Ir(jr(r, i), Dr(i - r)), G || Pr(0, c)), !G && !Gn && (Pr(0, 0), Ir(0, 0));
			}
		}
		if (Bn._x = G, Bn._y = Gn, e == null) {
			if (a) {
				if (ki != null) {
					let [e, t] = Oi.scales;
					Oi.values[0] = e == null ? null : Cr(D.ori == 0 ? U : W, e), Oi.values[1] = t == null ? null : Cr(D.ori == 1 ? U : W, t);
				}
				ji(Nn, r, U, W, z, B, o);
			}
			if (Ke) {
				let e = a && Oi.setSeries, t = Ge.prox;
				vr == null ? dr <= t && rr(fr, yr, !0, e) : dr > t ? rr(null, yr, !0, e) : fr != vr && rr(fr, yr, !0, e);
			}
		}
		Ie && (N.idx = o, Hr()), n !== !1 && Ei("setCursor");
	}
	let Yr = null;
	Object.defineProperty(r, "rect", { get() {
		return Yr ?? Zr(!1), Yr;
	} });
	function Zr(e = !1) {
		e ? Yr = null : (Yr = m.getBoundingClientRect(), Ei("syncRect", Yr));
	}
	function Qr(e, t, n, r, i, a, o) {
		P._lock || zn && e != null && e.movementX == 0 && e.movementY == 0 || (ti(e, t, n, r, i, a, o, !1, e != null), e == null ? Jr(t, !0, !1) : Jr(null, !0, !0));
	}
	function ti(e, t, n, i, a, o, c, l, u) {
		if (Yr ?? Zr(!1), Ue(e), e != null) n = e.clientX - Yr.left, i = e.clientY - Yr.top;
		else {
			if (n < 0 || i < 0) {
				U = -10, W = -10;
				return;
			}
			let [e, r] = Oi.scales, c = t.cursor.sync, [l, u] = c.values, [d, f] = c.scales, [p, m] = Oi.match, h = t.axes[0].side % 2 == 1, g = D.ori == 0 ? z : B, _ = D.ori == 1 ? z : B, v = h ? o : a, y = h ? a : o, x = h ? i : n, S = h ? n : i;
			if (n = d == null ? x / v * g : p(e, d) ? s(l, b[e], g, 0) : -10, i = f == null ? S / y * _ : m(r, f) ? s(u, b[r], _, 0) : -10, D.ori == 1) {
				let e = n;
				n = i, i = e;
			}
		}
		u && (t == null || t.cursor.event.type == Nn) && ((n <= 1 || n >= z - 1) && (n = Xr(n, z)), (i <= 1 || i >= B - 1) && (i = Xr(i, B))), l ? ($t = n, en = i, [tn, nn] = P.move(r, n, i)) : (U = n, W = i);
	}
	let oi = {
		width: 0,
		height: 0,
		left: 0,
		top: 0
	};
	function di() {
		Zn(oi, !1);
	}
	let fi, hi, gi, _i;
	function vi(e, t, n, i, a, o, s) {
		zn = !0, G = Gn = Bn._x = Bn._y = !1, ti(e, t, n, i, a, o, s, !0, !1), e != null && (ve(Fn, Un, yi, !1), ji(Pn, r, tn, nn, z, B, null));
		let { left: c, top: l, width: u, height: d } = q;
		fi = c, hi = l, gi = u, _i = d;
	}
	function yi(e, t, n, i, a, o, s) {
		zn = Bn._x = Bn._y = !1, ti(e, t, n, i, a, o, s, !1, !0);
		let { left: c, top: l, width: u, height: d } = q, f = u > 0 || d > 0, p = fi != c || hi != l || gi != u || _i != d;
		if (f && p && Zn(q), Bn.setScale && f && p) {
			let e = c, t = u, n = l, r = d;
			if (D.ori == 1 && (e = l, t = d, n = c, r = u), G && tr(S, Cr(e, S), Cr(e + t, S)), Gn) for (let e in b) {
				let t = b[e];
				e != S && t.from == null && t.min != X && tr(e, Cr(n + r, e), Cr(n, e));
			}
			di();
		} else P.lock && (P._lock = !P._lock, Jr(t, !0, e != null));
		e != null && (ye(Fn, Un), ji(Fn, r, U, W, z, B, null));
	}
	function xi(e, t, n, r, i, a, o) {
		if (P._lock) return;
		Ue(e);
		let s = zn;
		if (zn) {
			let e = !0, t = !0, n, r;
			D.ori == 0 ? (n = G, r = Gn) : (n = Gn, r = G), n && r && (e = U <= 10 || U >= z - 10, t = W <= 10 || W >= B - 10), n && e && (U = U < tn ? 0 : z), r && t && (W = W < nn ? 0 : B), Jr(null, !0, !0), zn = !1;
		}
		U = -10, W = -10, ie.fill(null), Jr(null, !0, !0), s && (zn = s);
	}
	function Si(e, t, n, i, a, o, s) {
		P._lock || (Ue(e), dt(), di(), e != null && ji(Rn, r, U, W, z, B, null));
	}
	function Ci() {
		y.forEach($o), Le(r.width, r.height, !0);
	}
	ar(Vn, Wn, Ci);
	let wi = {};
	wi.mousedown = vi, wi.mousemove = Qr, wi.mouseup = yi, wi.dblclick = Si, wi.setSeries = (e, t, n, i) => {
		let a = Oi.match[2];
		n = a(r, t, n), n != -1 && rr(n, i, !0, !1);
	}, ae && (ve(Pn, m, vi), ve(Nn, m, Qr), ve(In, m, (e) => {
		Ue(e), Zr(!1);
	}), ve(Ln, m, xi), ve(Rn, m, Si), Lo.add(r), r.syncRect = Zr);
	let Ti = r.hooks = e.hooks || {};
	function Ei(e, t, n) {
		Ht ? Ut.push([
			e,
			t,
			n
		]) : e in Ti && Ti[e].forEach((e) => {
			e.call(null, r, t, n);
		});
	}
	(e.plugins || []).forEach((e) => {
		for (let t in e.hooks) Ti[t] = (Ti[t] || []).concat(e.hooks[t]);
	});
	let Di = (e, t, n) => n, Oi = mi({
		key: null,
		setSeries: !1,
		filters: {
			pub: Kr,
			sub: Kr
		},
		scales: [S, v[1] ? v[1].scale : null],
		match: [
			qr,
			qr,
			Di
		],
		values: [null, null]
	}, P.sync);
	Oi.match.length == 2 && Oi.match.push(Di), P.sync = Oi;
	let ki = Oi.key, Ai = ro(ki);
	function ji(e, t, n, r, i, a, o) {
		Oi.filters.pub(e, t, n, r, i, a, o) && Ai.pub(e, t, n, r, i, a, o);
	}
	Ai.sub(r);
	function Ni(e, t, n, r, i, a, o) {
		Oi.filters.sub(e, t, n, r, i, a, o) && wi[e](null, t, n, r, i, a, o);
	}
	r.pub = Ni;
	function Pi() {
		Ai.unsub(r), Lo.delete(r), _e.clear(), or(Vn, Wn, Ci), l.remove(), L?.remove(), Ei("destroy");
	}
	r.destroy = Pi;
	function Fi() {
		Ei("init", e, t), ut(t || e.data, !1), j[S] ? Jt(S, j[S]) : dt(), Fe = q.show && (q.width > 0 || q.height > 0), Pe = Ie = !0, Le(e.width, e.height);
	}
	return v.forEach(Ze), y.forEach(tt), n ? n instanceof HTMLElement ? (n.appendChild(l), Fi()) : n(r, Fi) : Fi(), r;
}
es.assign = mi, es.fmtNum = wr, es.rangeNum = br, es.rangeLog = mr, es.rangeAsinh = hr, es.orient = oo, es.pxRatio = K, es.join = yi, es.fmtDate = Mi, es.tzDate = Pi, es.sync = ro;
{
	es.addGap = fo, es.clipGaps = uo;
	let e = es.paths = { points: Eo };
	e.linear = Ao, e.stepped = jo, e.bars = No, e.spline = Fo;
}
// src/plots.tsx
var ts = [
	"--c1",
	"--c2",
	"--c3",
	"--c4",
	"--c5",
	"--c6"
];
function ns({ store: e, state: t }) {
	let [n, r] = lt(null), [i, a] = lt(!1), [o, s] = lt(800), c = ft(null), l = t.run, [u, d] = t.span;
	dt(() => {
		let e = c.current;
		if (!e) return;
		let t = new ResizeObserver(() => s(Math.max(200, e.clientWidth - 18)));
		return t.observe(e), () => t.disconnect();
	}, [!l]);
	let f = t.plotted.join("\n");
	if (dt(() => {
		if (!l) return;
		let n = !1, a = i ? t.runs.filter((e) => e.tEnd !== void 0) : [l];
		return Promise.all(a.map((n) => e.transport.ask("curves", {
			run: n.run,
			names: t.plotted,
			t0: u,
			t1: d,
			width: o,
			strip: n.run === l.run
		}).then((e) => ({
			run: n,
			...e
		})))).then((e) => !n && r({
			runs: e,
			strip: e.find((e) => e.run.run === l.run)?.strip ?? []
		})).catch((t) => e.refused(t)), () => {
			n = !0;
		};
	}, [
		l?.run,
		f,
		u,
		d,
		o,
		i,
		t.runs.length
	]), t.running && t.soFar) return /* @__PURE__ */ R(rs, {
		state: t,
		soFar: t.soFar
	});
	if (!l || l.tEnd === void 0) return /* @__PURE__ */ R("p", {
		class: "hint plots",
		children: l?.error ? "" : t.running ? "Running …" : "Press Run."
	});
	let p = t.cursor?.t ?? null, m = u === l.tBegin && d === l.tEnd;
	return /* @__PURE__ */ R("div", {
		class: "plots",
		ref: c,
		children: [
			/* @__PURE__ */ R("div", {
				class: "plotbar",
				children: [
					/* @__PURE__ */ R(is, {
						store: e,
						state: t,
						run: l
					}),
					t.runs.length > 1 && /* @__PURE__ */ R("label", { children: [
						/* @__PURE__ */ R("input", {
							type: "checkbox",
							checked: i,
							onChange: (e) => a(e.currentTarget.checked)
						}),
						" compare ",
						t.runs.length,
						" runs"
					] }),
					!m && /* @__PURE__ */ R("button", {
						onClick: () => e.set({ span: [l.tBegin, l.tEnd] }),
						children: "Whole run"
					}),
					/* @__PURE__ */ R("label", {
						class: "scrub",
						children: [
							/* @__PURE__ */ R("span", { children: "t" }),
							/* @__PURE__ */ R("input", {
								type: "range",
								"aria-label": "Time cursor",
								min: l.tBegin,
								max: l.tEnd,
								step: (l.tEnd - l.tBegin) / 1e3 || 1,
								value: p ?? l.tBegin,
								onInput: (t) => {
									e.set({ instant: null }), e.moveCursor(Number(t.currentTarget.value));
								}
							}),
							/* @__PURE__ */ R("output", { children: p === null ? "" : Ve(p, "s") })
						]
					}),
					/* @__PURE__ */ R("label", { children: [/* @__PURE__ */ R("input", {
						type: "checkbox",
						checked: t.flowing,
						onChange: (t) => e.set({ flowing: t.currentTarget.checked })
					}), " power"] })
				]
			}),
			t.plotted.map((r, i) => /* @__PURE__ */ R(as, {
				name: r,
				ink: ts[i % ts.length],
				curves: (n?.runs ?? []).flatMap((e) => e.curves.filter((e) => e.name === r)),
				span: t.span,
				cursor: p,
				wide: o,
				dark: t.dark,
				last: i === t.plotted.length - 1,
				onSpan: (t) => e.set({ span: t }),
				onTime: (t) => {
					e.set({ instant: null }), e.moveCursor(t);
				}
			}, r)),
			/* @__PURE__ */ R(ls, {
				lanes: n?.strip ?? [],
				span: t.span,
				cursor: p,
				onTime: (t) => void e.moveCursor(t)
			})
		]
	});
}
function rs({ state: e, soFar: t }) {
	let n = ft(null), r = [t.tBegin, t.tEnd];
	return /* @__PURE__ */ R("div", {
		class: "plots",
		ref: n,
		children: [t.curves.map((i, a) => /* @__PURE__ */ R(as, {
			name: i.name,
			ink: ts[a % ts.length],
			curves: [i],
			span: r,
			cursor: null,
			wide: (n.current?.clientWidth ?? 800) - 18,
			dark: e.dark,
			last: a === t.curves.length - 1,
			onSpan: () => {},
			onTime: () => {}
		}, i.name)), /* @__PURE__ */ R(ls, {
			lanes: t.strip,
			span: r,
			cursor: null,
			onTime: () => {}
		})]
	});
}
function is({ store: e, state: t, run: n }) {
	let r = (t.look?.view.nodes ?? []).flatMap((e) => e.kind === "part" ? [] : [`${e.name}.e`, `${e.name}.f`]), i = [.../* @__PURE__ */ new Set([...n.names, ...r])].filter((e) => !t.plotted.includes(e));
	return /* @__PURE__ */ R("span", {
		class: "chooser",
		children: [
			t.plotted.map((n) => /* @__PURE__ */ R("button", {
				class: "chip",
				"aria-label": `Do not plot ${n}`,
				onClick: () => e.set({ plotted: t.plotted.filter((e) => e !== n) }),
				children: [n, " ✕"]
			})),
			/* @__PURE__ */ R("input", {
				"aria-label": "Plot a signal",
				placeholder: "plot …",
				list: "signals",
				onKeyDown: (e) => e.stopPropagation(),
				onChange: (n) => {
					let r = n.currentTarget.value.trim();
					r && e.set({ plotted: [...t.plotted, r] }), n.currentTarget.value = "";
				}
			}),
			/* @__PURE__ */ R("datalist", {
				id: "signals",
				children: i.map((e) => /* @__PURE__ */ R("option", { value: e }))
			})
		]
	});
}
var as = class extends S {
	box = b();
	plot = null;
	componentDidMount() {
		this.draw();
	}
	componentDidUpdate(e) {
		let t = this.props;
		e.wide === t.wide && e.dark === t.dark && e.last === t.last && e.curves.length === t.curves.length && e.curves.every((e, n) => e === t.curves[n]) ? e.cursor !== t.cursor && this.plot?.redraw(!1) : this.draw();
	}
	componentWillUnmount() {
		this.plot?.destroy();
	}
	draw() {
		this.plot?.destroy(), this.plot = null;
		let { curves: e, span: t, wide: n, last: r, name: i } = this.props, a = this.box.current;
		a.replaceChildren();
		let o = e.filter((e) => !e.error);
		if (!o.length) return;
		let s = getComputedStyle(a), c = s.getPropertyValue("--ink"), l = s.getPropertyValue("--line"), u = o.map((e, t) => s.getPropertyValue(t === o.length - 1 ? this.props.ink : ts[(t + 3) % ts.length])), d = o.map((e) => [e.t, e.y]), f = d.length === 1 ? d[0] : es.join(d), p = o[o.length - 1].unit, m = o.flatMap((e) => e.impulses);
		this.plot = new es({
			width: Math.max(n - 4, 200),
			height: r ? 132 : 112,
			padding: [
				8,
				24,
				0,
				0
			],
			legend: { show: !1 },
			cursor: {
				drag: {
					x: !0,
					y: !1
				},
				points: { show: !1 }
			},
			scales: {
				x: {
					time: !1,
					range: () => t
				},
				y: { range: (e, t, n) => os(t, n, m.length > 0) }
			},
			axes: [{
				show: r,
				stroke: c,
				grid: {
					stroke: l,
					width: 1
				},
				ticks: { stroke: l },
				size: 26,
				values: (e, t) => ss(t, "s")
			}, {
				stroke: c,
				grid: {
					stroke: l,
					width: 1
				},
				ticks: { stroke: l },
				size: 74,
				label: i,
				labelSize: 18,
				labelFont: "11px sans-serif",
				font: "10px sans-serif",
				values: (e, t) => ss(t, p)
			}],
			series: [{}, ...o.map((e, t) => ({
				stroke: u[t],
				width: 1.5,
				points: { show: !1 },
				pxAlign: 0,
				spanGaps: d.length > 1
			}))],
			hooks: {
				draw: [(e) => {
					this.arrows(e, m, u[u.length - 1], p), this.timeline(e, c);
				}],
				setSelect: [(e) => {
					e.select.width < 4 || this.props.onSpan([e.posToVal(e.select.left, "x"), e.posToVal(e.select.left + e.select.width, "x")]);
				}]
			}
		}, f, a);
		let h = this.plot.over, g = 0;
		h.addEventListener("mousedown", (e) => g = e.clientX), h.addEventListener("click", (e) => {
			Math.abs(e.clientX - g) < 4 && this.plot && this.props.onTime(this.plot.posToVal(e.offsetX, "x"));
		}), h.addEventListener("dblclick", () => this.props.onSpan([o[0].t[0], o[0].t[o[0].t.length - 1]]));
	}
	arrows(e, t, n, r) {
		if (!t.length) return;
		let i = Math.max(...t.map(([, e]) => Math.abs(e))), { left: a, top: o, width: s, height: c } = e.bbox, l = Math.min(Math.max(e.valToPos(0, "y", !0), o), o + c), u = e.ctx, d = devicePixelRatio;
		u.save(), u.strokeStyle = u.fillStyle = n, u.lineWidth = 1.5 * d, u.font = `${10 * d}px sans-serif`;
		for (let [n, f] of t) {
			let p = e.valToPos(n, "x", !0);
			if (p < a || p > a + s) continue;
			let m = l - Math.sign(f) * (.25 + .3 * Math.abs(f) / i) * c, h = Math.min(Math.max(m, o + 6 * d), o + c - 6 * d), g = Math.sign(h - l) || 1;
			if (u.beginPath(), u.moveTo(p, l), u.lineTo(p, h), u.moveTo(p - 4 * d, h - 7 * d * g), u.lineTo(p, h), u.lineTo(p + 4 * d, h - 7 * d * g), u.stroke(), t.length <= 12) {
				let e = `${Ve(f, r ? r + "s" : "")} δ`, t = p + 8 * d + u.measureText(e).width < a + s;
				u.textAlign = t ? "left" : "right", u.fillText(e, p + (t ? 6 : -6) * d, (l + h) / 2);
			}
		}
		u.restore();
	}
	timeline(e, t) {
		let n = this.props.cursor;
		if (n === null) return;
		let r = e.valToPos(n, "x", !0), { left: i, top: a, width: o, height: s } = e.bbox;
		r < i || r > i + o || (e.ctx.save(), e.ctx.strokeStyle = t, e.ctx.setLineDash([4, 3]), e.ctx.beginPath(), e.ctx.moveTo(r, a), e.ctx.lineTo(r, a + s), e.ctx.stroke(), e.ctx.restore());
	}
	render({ name: e, curves: t }) {
		let n = t.find((e) => e.error);
		return /* @__PURE__ */ R("figure", {
			class: "trace",
			"aria-label": `Plot of ${e}`,
			children: [/* @__PURE__ */ R("div", { ref: this.box }), n && /* @__PURE__ */ R("p", {
				class: "hint",
				children: [
					n.error.code,
					" ",
					n.error.why
				]
			})]
		});
	}
};
function os(e, t, n) {
	let [r, i] = [e ?? 0, t ?? 1];
	n && ([r, i] = [Math.min(r, 0), Math.max(i, 0)]);
	let a = .08 * (i - r) || .1 * Math.abs(r) || 1;
	return [r - a, i + a];
}
function ss(e, t) {
	let n = Math.max(...e.map(Math.abs)), r = [
		1e9,
		1e6,
		1e3,
		1,
		.001,
		1e-6,
		1e-9
	].find((e) => n >= e) ?? 1e-12, i = {
		1e9: "G",
		1e6: "M",
		1e3: "k",
		1: "",
		.001: "m",
		1e-6: "µ",
		1e-9: "n",
		1e-12: "p"
	}[r] ?? "", a = /^[A-Za-zΩ]+$/.test(t) && t !== "kg";
	return e.map((e) => a ? `${+(e / r).toPrecision(5)} ${i}${t}` : `${+e.toPrecision(5)} ${t}`);
}
var cs = [
	"var(--s0)",
	"var(--s1)",
	"var(--s2)",
	"var(--s3)",
	"var(--s4)",
	"var(--s5)",
	"var(--s6)",
	"var(--s7)"
];
function ls({ lanes: e, span: [t, n], cursor: r, onTime: i }) {
	if (!e.length) return null;
	let a = (e) => 1e3 * (e - t) / (n - t || 1);
	return /* @__PURE__ */ R("div", {
		class: "strip",
		children: [
			/* @__PURE__ */ R("div", {
				class: "stripnames",
				"aria-hidden": "true",
				children: e.map((e) => /* @__PURE__ */ R("span", {
					title: e.machine,
					children: e.machine
				}))
			}),
			/* @__PURE__ */ R("svg", {
				viewBox: `0 0 1000 ${18 * e.length}`,
				preserveAspectRatio: "none",
				style: { height: `${18 * e.length}px` },
				role: "img",
				"aria-label": `Modes: ${e.map((e) => `${e.machine} is ${e.stays?.map(([, , t]) => e.states[t]).slice(0, 12).join(", ") ?? "switching fast"}`).join("; ")}`,
				onClick: (e) => {
					let r = e.currentTarget.getBoundingClientRect();
					i(t + (e.clientX - r.left) / r.width * (n - t));
				},
				children: [e.map((e, r) => /* @__PURE__ */ R("g", {
					transform: `translate(0,${r * 18})`,
					children: [e.stays?.map(([r, i, o]) => /* @__PURE__ */ R("rect", {
						x: a(Math.max(r, t)),
						width: Math.max(.7, a(Math.min(i, n)) - a(Math.max(r, t))),
						y: 1,
						height: 16,
						fill: cs[o % cs.length],
						children: /* @__PURE__ */ R("title", { children: e.states[o] })
					})), e.shares?.map((e, t) => e.map((n, r) => n > 0 ? /* @__PURE__ */ R("rect", {
						x: 1e3 * r / e.length,
						width: 1e3 / e.length,
						y: 1,
						height: 16,
						fill: cs[t % cs.length],
						opacity: n
					}) : null))]
				})), r !== null && r >= t && r <= n && /* @__PURE__ */ R("line", {
					class: "now",
					x1: a(r),
					x2: a(r),
					y1: 0,
					y2: 18 * e.length
				})]
			}),
			/* @__PURE__ */ R("div", {
				class: "stripwords",
				"aria-hidden": "true",
				children: e.map((e, r) => e.stays?.filter(([e, r]) => a(Math.min(r, n)) - a(Math.max(e, t)) > 60).map(([i, o, s]) => /* @__PURE__ */ R("span", {
					style: {
						left: `${(a(Math.max(i, t)) + a(Math.min(o, n))) / 20}%`,
						top: `${r * 18}px`
					},
					children: e.states[s]
				})))
			})
		]
	});
}
// src/app.tsx
var us = [
	["item", "Properties"],
	["machines", "Machines"],
	["model", "Model"],
	["problems", "Problems"],
	["table", "Table"],
	["text", "Text"],
	["equations", "Equations"]
], ds = class extends S {
	state = this.props.store.state;
	stop = () => {};
	componentDidMount() {
		this.stop = this.props.store.subscribe(() => this.setState(this.props.store.state)), this.setState(this.props.store.state), document.addEventListener("copy", this.copy), document.addEventListener("cut", this.copy), document.addEventListener("paste", this.paste), document.addEventListener("keydown", this.key);
	}
	componentWillUnmount() {
		this.stop(), document.removeEventListener("copy", this.copy), document.removeEventListener("cut", this.copy), document.removeEventListener("paste", this.paste), document.removeEventListener("keydown", this.key);
	}
	onCanvas() {
		let e = document.activeElement;
		return !!e?.closest?.(".studio") && !/^(INPUT|TEXTAREA|SELECT)$/.test(e.tagName);
	}
	held = "";
	copy = (e) => {
		if (!this.onCanvas() || String(getSelection() ?? "")) return;
		let { store: t } = this.props;
		if (!t.state.nodes.size) return;
		e.preventDefault();
		let n = e.type === "cut";
		t.copy().then((e) => {
			this.held = e, navigator.clipboard?.writeText(e).catch(() => {}), n && t.remove();
		});
	};
	paste = (e) => {
		if (!this.onCanvas()) return;
		let t = e.clipboardData?.getData("text/plain") || this.held;
		t.includes("elements") && (e.preventDefault(), this.props.store.paste(t));
	};
	key = (e) => {
		let t = e.ctrlKey || e.metaKey, { store: n } = this.props;
		if (!t || !this.onCanvas()) return;
		let r = e.key.toLowerCase();
		if (r === "z" && !e.shiftKey) n.undo();
		else if (r === "y" || r === "z" && e.shiftKey) n.redo();
		else if (r !== "s") {
			if (r === "enter") n.start();
			else return;
		}
		e.preventDefault();
	};
	render({ store: e }, t) {
		let n = t.look;
		if (!n) return /* @__PURE__ */ R("div", {
			class: "studio loading",
			role: "status",
			children: t.connected ? "Opening …" : "Connecting …"
		});
		let r = t.dark === null ? "" : t.dark ? " dark" : " light", i = n.problems.filter((e) => e.grave === "error").length, a = n.problems.length - i, o = [...t.nodes, ...[...t.bonds].map((e) => n.view.bonds.find((t) => t.key === e)?.text)].join(", ");
		return /* @__PURE__ */ R("main", {
			class: "studio" + r + (t.bottom ? " withbottom" : ""),
			children: [
				/* @__PURE__ */ R(ps, {
					store: e,
					state: t,
					errors: i
				}),
				/* @__PURE__ */ R("div", {
					class: "middle",
					children: [
						/* @__PURE__ */ R(nn, {
							store: e,
							state: t
						}),
						/* @__PURE__ */ R(He, {
							store: e,
							state: t
						}),
						/* @__PURE__ */ R("aside", {
							class: "side" + (t.panel === "side" ? " open" : ""),
							"aria-label": "Panels",
							children: [/* @__PURE__ */ R("div", {
								class: "tabs",
								role: "tablist",
								"aria-label": "Panels",
								children: us.map(([r, a]) => /* @__PURE__ */ R("button", {
									role: "tab",
									id: `tab-${r}`,
									"aria-controls": "panel",
									"aria-selected": t.tab === r,
									onClick: () => e.set({ tab: r }),
									children: [a, r === "problems" && n.problems.length > 0 && /* @__PURE__ */ R("span", {
										class: "count" + (i ? " error" : ""),
										children: n.problems.length
									})]
								}))
							}), /* @__PURE__ */ R("div", {
								class: "panel",
								id: "panel",
								role: "tabpanel",
								"aria-labelledby": `tab-${t.tab}`,
								tabindex: 0,
								children: [
									t.tab === "item" && /* @__PURE__ */ R(Pt, {
										store: e,
										state: t
									}),
									t.tab === "machines" && /* @__PURE__ */ R(Gt, {
										store: e,
										state: t
									}),
									t.tab === "model" && /* @__PURE__ */ R(Jt, {
										store: e,
										state: t
									}),
									t.tab === "problems" && /* @__PURE__ */ R(Qt, {
										store: e,
										state: t
									}),
									t.tab === "table" && /* @__PURE__ */ R($t, {
										store: e,
										state: t
									}),
									t.tab === "text" && /* @__PURE__ */ R(en, {
										store: e,
										state: t
									}),
									t.tab === "equations" && /* @__PURE__ */ R(Ot, {
										store: e,
										state: t
									})
								]
							})]
						})
					]
				}),
				t.bottom && /* @__PURE__ */ R("div", {
					class: "bottom",
					children: [/* @__PURE__ */ R(ns, {
						store: e,
						state: t
					}), /* @__PURE__ */ R(Ct, {
						store: e,
						state: t
					})]
				}),
				/* @__PURE__ */ R("footer", { children: [
					/* @__PURE__ */ R("span", {
						id: "chosen",
						role: "status",
						"aria-live": "polite",
						children: o || (n.whole ? "" : "strokes of what is joined so far")
					}),
					/* @__PURE__ */ R(fs, {
						store: e,
						state: t
					}),
					/* @__PURE__ */ R("button", {
						class: "verdict" + (i ? " error" : a ? " hint" : ""),
						onClick: () => e.set({
							tab: "problems",
							panel: "side"
						}),
						children: i ? `${i} ${i === 1 ? "problem" : "problems"}: ${n.problems[0].code} ${n.problems[0].where}` : a ? `${a} hint${a > 1 ? "s" : ""}` : "fine"
					}),
					/* @__PURE__ */ R("button", {
						class: "verdict",
						"aria-pressed": t.bottom,
						onClick: () => e.set({ bottom: !t.bottom }),
						children: "plots"
					})
				] }),
				t.adding && n.view.editable && /* @__PURE__ */ R(rn, {
					store: e,
					state: t
				}),
				t.notice && /* @__PURE__ */ R("div", {
					class: "notice",
					role: "alert",
					children: [
						/* @__PURE__ */ R("b", { children: t.notice.code }),
						" ",
						t.notice.where && /* @__PURE__ */ R("i", { children: [t.notice.where, ": "] }),
						t.notice.why,
						t.notice.try && /* @__PURE__ */ R("em", { children: [" Try: ", t.notice.try] }),
						/* @__PURE__ */ R("button", {
							"aria-label": "Close this message",
							onClick: () => e.set({ notice: null }),
							children: "✕"
						})
					]
				}),
				!t.connected && /* @__PURE__ */ R("div", {
					class: "notice",
					role: "alert",
					children: "The studio does not answer. What you did is in the file; trying again …"
				})
			]
		});
	}
};
function fs({ store: e, state: t }) {
	let n = t.look.machines, r = t.cursor?.mode;
	return n.length ? /* @__PURE__ */ R("span", {
		class: "modes",
		children: [
			t.cursor && /* @__PURE__ */ R("b", { children: [
				"t = ",
				+t.cursor.t.toPrecision(6),
				" s"
			] }),
			n.slice(0, 8).map((t) => /* @__PURE__ */ R("label", { children: [t.path, /* @__PURE__ */ R("select", {
				"aria-label": `State of ${t.path} that is drawn`,
				value: r?.[t.path] ?? t.state,
				onChange: (n) => e.setMode(t.path, n.currentTarget.value),
				children: t.states.map((e) => /* @__PURE__ */ R("option", { children: e }))
			})] })),
			n.length > 8 && `and ${n.length - 8} more`
		]
	}) : null;
}
function ps({ store: e, state: t, errors: n }) {
	let r = t.look, i = t.running, a = Number(r.panels.experiment.until) || t.run?.until || 1;
	return /* @__PURE__ */ R("header", { children: [
		/* @__PURE__ */ R(ms, {
			store: e,
			state: t
		}),
		/* @__PURE__ */ R("h1", {
			title: r.file,
			children: r.title || r.file
		}),
		/* @__PURE__ */ R("span", {
			class: "saved" + (r.unsaved ? " error" : ""),
			role: "status",
			children: r.unsaved ? `not saved: ${r.unsaved}` : r.inMemory ? "in memory" : r.writable ? "saved" : "read only: open in another studio"
		}),
		/* @__PURE__ */ R("span", { class: "spring" }),
		/* @__PURE__ */ R("button", {
			class: "narrow",
			"aria-label": "Palette",
			"aria-pressed": t.panel === "palette",
			onClick: () => e.set({ panel: t.panel === "palette" ? "" : "palette" }),
			children: "＋"
		}),
		/* @__PURE__ */ R("button", {
			class: "narrow",
			"aria-label": "Panels",
			"aria-pressed": t.panel === "side",
			onClick: () => e.set({ panel: t.panel === "side" ? "" : "side" }),
			children: "☰"
		}),
		/* @__PURE__ */ R("button", {
			title: "Undo (Ctrl+Z)",
			"aria-label": "Undo",
			disabled: !r.canUndo,
			onClick: e.undo,
			children: "↶"
		}),
		/* @__PURE__ */ R("button", {
			title: "Redo (Ctrl+Y)",
			"aria-label": "Redo",
			disabled: !r.canRedo,
			onClick: e.redo,
			children: "↷"
		}),
		/* @__PURE__ */ R("button", {
			class: "wide",
			disabled: !r.view.editable || !r.view.nodes.length,
			title: "Lay out anew; selected elements stay where they are",
			onClick: () => void e.ask("arrange", { keep: [...t.nodes] }),
			children: "Arrange"
		}),
		i ? /* @__PURE__ */ R(x, { children: [/* @__PURE__ */ R("progress", {
			"aria-label": "Progress of the run",
			max: a,
			value: i.t
		}), /* @__PURE__ */ R("button", {
			class: "run",
			onClick: e.cancel,
			children: "Cancel"
		})] }) : /* @__PURE__ */ R("button", {
			class: "run",
			disabled: n > 0,
			title: "Run (Ctrl+Enter)",
			onClick: () => void e.start(),
			children: "▶ Run"
		}),
		/* @__PURE__ */ R("button", {
			"aria-label": "Dark or light",
			title: "Dark or light",
			onClick: () => e.set({ dark: !(t.dark ?? matchMedia("(prefers-color-scheme: dark)").matches) }),
			children: "◐"
		})
	] });
}
function ms({ store: e, state: t }) {
	let n = (e) => e.currentTarget.closest("details").removeAttribute("open"), r = (t) => {
		e.set({
			level: "",
			mode: null,
			nodes: /* @__PURE__ */ new Set(),
			bonds: /* @__PURE__ */ new Set(),
			run: null,
			cursor: null,
			instant: null,
			plotted: [],
			bottom: !1
		}), e.ask("open", {
			...t,
			level: ""
		});
	}, i = () => {
		let t = prompt("Name of the file", "model.toml");
		t && e.ask("save as", { file: t.endsWith(".toml") ? t : `${t}.toml` });
	}, a = async (n) => {
		try {
			let { content: r, name: i } = await e.transport.ask("picture", {
				form: n,
				mode: t.mode
			}), a = Uint8Array.from(atob(r), (e) => e.charCodeAt(0)), o = document.createElement("a");
			o.href = URL.createObjectURL(new Blob([a])), o.download = i, o.click(), URL.revokeObjectURL(o.href);
		} catch (t) {
			e.refused(t);
		}
	}, o = t.stock;
	return /* @__PURE__ */ R("details", {
		class: "menu",
		children: [/* @__PURE__ */ R("summary", {
			"aria-label": "Menu",
			children: "hybond"
		}), /* @__PURE__ */ R("div", {
			class: "sheet",
			onClick: (e) => e.target.tagName === "BUTTON" && n(e),
			children: [
				/* @__PURE__ */ R("button", {
					onClick: () => r({}),
					children: "New model"
				}),
				/* @__PURE__ */ R("button", {
					onClick: i,
					children: "Save as …"
				}),
				/* @__PURE__ */ R("hr", {}),
				[
					"svg",
					"pdf",
					"png",
					"tex"
				].map((e) => /* @__PURE__ */ R("button", {
					onClick: () => void a(e),
					children: ["Picture as ", e === "tex" ? "TikZ" : e.toUpperCase()]
				})),
				/* @__PURE__ */ R("hr", {}),
				/* @__PURE__ */ R("label", { children: [
					"open",
					" ",
					/* @__PURE__ */ R("select", {
						"aria-label": "Open a file",
						value: "",
						onChange: (e) => {
							r({ file: e.currentTarget.value }), n(e);
						},
						children: [/* @__PURE__ */ R("option", {
							value: "",
							children: "a file …"
						}), o?.files.map((e) => /* @__PURE__ */ R("option", { children: e }))]
					})
				] }),
				/* @__PURE__ */ R("label", { children: [
					"open",
					" ",
					/* @__PURE__ */ R("select", {
						"aria-label": "Open an example",
						value: "",
						onChange: (e) => {
							r({ example: e.currentTarget.value }), n(e);
						},
						children: [/* @__PURE__ */ R("option", {
							value: "",
							children: "an example …"
						}), o?.examples.map((e) => /* @__PURE__ */ R("option", { children: e }))]
					})
				] }),
				/* @__PURE__ */ R("small", { children: ["hybond ", o?.version] })
			]
		})]
	});
}
// src/widget.tsx
function hs({ model: e, el: t }) {
	let n = new Ie(), r = new Re(n), i = (e) => n.received(e);
	return e.on("msg:custom", i), n.connected({ send: (t) => e.send(t) }), t.style.height = `${e.get("height")}px`, t.classList.add("hybond-widget"), L(/* @__PURE__ */ R(ds, { store: r }), t), r.begin(), () => {
		e.off("msg:custom", i), L(null, t);
	};
}
var gs = { render: hs };
export { gs as default, hs as render };
