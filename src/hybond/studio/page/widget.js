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
	s && ((n = g({ constructor: u }, r)).__v = r.__v + 1, e.vnode && e.vnode(n), re(s, n, r, t.__n, s.namespaceURI, 32 & r.__u ? [i] : null, a, i || C(r), 32 & r.__u, o), n.__v = r.__v, n.__.__k[n.__i] = n, M(a, n, o), r.__ = r.__e = null, n.__e != i && T(n));
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
	for (c = k(n, t, y, c, b), p = 0; p < b; p++) (h = n.__k[p]) != null && (m = ~h.__i && y[h.__i] || d, h.__i = p, v = re(e, h, m, i, a, o, s, c, l, u), g = h.__e, (m.ref != h.ref || 8 & m.__u) && (m.ref && P(m.ref, null, h, m), h.ref && u.push(h.ref, h.__c || g, h)), _ ||= g, 4 & h.__u ? (c = A(h, c, e, !m.__v), m.__e && (m.__e = null)) : typeof h.type == "function" && v !== void 0 ? c = v : g && (c = g.nextSibling), h.__u &= -21);
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
	if (_) for (a = 0; a < g; a++) !(s = n[a]) || 2 & s.__u || (s.__e == r && (r = C(s)), oe(s, s));
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
function ee(e, t, n) {
	n ??= "", t[0] == "-" ? e.setProperty(t, n) : e[t] = n;
}
function te(e, t, n, r, i) {
	var a, o;
	if (t == "style") {
		if (typeof n == "string") e.style.cssText = n;
		else {
			if (typeof r == "string" && (e.style.cssText = r = ""), r) for (t in r) n && t in n || ee(e.style, t);
			if (n) for (t in n) r && n[t] == r[t] || ee(e.style, t, n[t]);
		}
	} else if (t[0] == "o" && t[1] == "n") typeof n != "function" && (n = null), typeof r != "function" && (r = null), (e.__e ||= {})[t] = n, n && r || (o = l[t] || (l[t] = ne(t)), (e.__a ||= {})[t] = c, a = t != (t = t.replace(s, "$1")), (t = t.slice(2))[0] < "a" && (t = t.toLowerCase()), n ? e.addEventListener(t, o, a) : e.removeEventListener(t, o, a));
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
function ne(t) {
	return function(n) {
		var r = this.__e;
		if (r) {
			if (r = r[t], n[o] == null) n[o] = c++;
			else if (n[o] < this.__a[t]) return;
			return r(e.event ? e.event(n) : n);
		}
	};
}
function re(t, n, r, i, a, o, s, c, l, d) {
	var p, h, v, y, b, w, T, E, D, k, A, j, ee, te, ne, re, M, P, F = n.type;
	if (n.constructor !== u) return null;
	128 & r.__u && (l = 32 & r.__u, p = r.__c.__z) && (n.__u |= l, h = o = [], p.nodeType == 8 ? c = ie(p, o) : o.push(p), c = o[0] || c), (p = e.__b) && p(n);
	n: if (typeof F == "function") {
		v = s.length;
		try {
			if (E = n.props, D = (p = F.prototype) && p.render, k = (p = F.contextType) && i[p.__c], A = p ? k ? k.props.value : p.__ : i, (y = r.__c) ? (n.__c = y, 2 & y.__g && (y.__g |= 1)) : (D ? n.__c = y = new F(E, A) : (n.__c = y = new S(E, A), y.constructor = F, y.render = se), k && k.sub(y), y.state || (y.state = {}), y.__n = i, y.__g |= 8, y.__h = [], y.__k = []), D && (y.__s || (y.__s = y.state), F.getDerivedStateFromProps && (y.__s == y.state && (y.__s = g({}, y.__s)), g(y.__s, F.getDerivedStateFromProps(E, y.__s)))), b = y.props, w = y.state, y.__v = n, r.__c) {
				if (E !== b && D && !F.getDerivedStateFromProps && y.componentWillReceiveProps && y.componentWillReceiveProps(E, A), n.__v == r.__v && !(8 & y.__g) || !(4 & y.__g) && y.shouldComponentUpdate && !1 === y.shouldComponentUpdate(E, y.__s, A)) {
					n.__v != r.__v && (y.props = E, y.state = y.__s, y.__g &= -9), n.__e = r.__e, n.__k = r.__k, n.__k.some(function(e) {
						e && (e.__ = n);
					}), f.push.apply(y.__h, y.__k), y.__k = [], y.__h.length && s.push(y), c = C(r);
					break n;
				}
				y.componentWillUpdate && y.componentWillUpdate(E, y.__s, A), D && y.componentDidUpdate && y.__h.push(function() {
					y.componentDidUpdate(b, w, T);
				});
			} else D && !F.getDerivedStateFromProps && y.componentWillMount && y.componentWillMount(), D && y.componentDidMount && y.__h.push(y.componentDidMount);
			y.context = A, y.props = E, y.__P = t, y.__g &= -5, j = e.__r, ee = D ? 25 : 0;
			do
				y.__g &= -9, j && j(n), p = y.render(y.props, y.state = y.__s, y.context);
			while (8 & y.__g && ++ee < 25);
			D && (f.push.apply(y.__h, y.__k), y.__k = []), y.state = y.__s, y.getChildContext && (i = g({}, i, y.getChildContext())), D && r.__c && y.getSnapshotBeforeUpdate && (T = y.getSnapshotBeforeUpdate(b, w)), te = p && p.type === x && p.key == null ? p.props.children : p, E.__P && (p = c, a = (t = E.__P).namespaceURI, l = o = null, r.props && r.props.__P != t && (r.__k.some(function(e) {
				e && oe(e, e);
			}), r.__k = null), c = r.__k ? C(r, 0) : null), c = O(t, m(te) ? te : [te], n, r, i, a, o, s, c, l, d), E.__P && (n.__e = null, c = p), n.__u &= -161, h && h.some(_), y.__h.length && s.push(y), 1 & y.__g && (y.__g &= -4);
		} catch (t) {
			if (s.length = v, n.__v = null, l || o) {
				if (t && t.then) {
					if (n.__u |= 128 | l, o) {
						for (~(M = o.indexOf(c || void 0)) || (M = o.length); (P = o[M - 1]) && P.nodeType == 8;) M--;
						for (; M < o.length; M++) if (P = o[M]) {
							if (o[M] = null, ne) {
								if (P == re) break;
							} else {
								if (P.nodeType != 8) break;
								P.data.startsWith("$s") && (re = ie(ne = P));
							}
						}
					}
					if (!ne) {
						for (; c && c.nodeType == 8 && c.nextSibling;) c = c.nextSibling;
						ne = c;
					}
					(p = ie(ne = n.__c.__z || (n.__c.__z = ne))) ? (n.__e = ne, c = p) : n.__e = c, c &&= c.nextSibling;
				} else o && o.some(_);
			} else n.__e = r.__e;
			n.__k ||= r.__k || [], t && t.then || ae(n), e.__e(t, n, r);
		}
	} else c = n.__e = N(r.__e, n, r, i, a, o, s, l, d, t);
	return (p = e.diffed) && p(n), c;
}
function ie(e, t) {
	if (e && e.nodeType == 8 && e.data.startsWith("$s")) for (var n = 1; e = e.nextSibling;) {
		if (e.nodeType == 8) {
			if (e.data.startsWith("$s")) n++;
			else if (e.data.startsWith("/$s") && !--n) return e;
		}
		t && t.push(e);
	}
}
function ae(e) {
	e && (e.__c && (e.__c.__g |= 4), e.__k && e.__k.some(ae));
}
function M(t, n, r) {
	for (var i = 0; i < r.length;) P(r[i++], r[i++], r[i++]);
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
function N(t, n, r, i, a, o, s, c, l, u) {
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
		for (f in T) b = T[f], f == "dangerouslySetInnerHTML" ? v = b : f == "children" || f in E || f == "value" && "defaultValue" in E || f == "checked" && "defaultChecked" in E || te(t, f, null, b, a);
		for (f in E) b = E[f], f == "children" ? y = b : f == "dangerouslySetInnerHTML" ? g = b : f == "value" ? x = b : f == "checked" ? S = b : c && typeof b != "function" || T[f] === b || te(t, f, b, T[f], a);
		g ? (c || v && (g.__html == v.__html || g.__html == t.innerHTML) || (t.innerHTML = g.__html), n.__k = []) : (v && (t.textContent = ""), (D == "foreignObject" || a == "http://www.w3.org/1998/Math/MathML" && p.test(D)) && (a = "http://www.w3.org/1999/xhtml"), O(u, m(y) ? y : [y], n, r, i, a, o, s, o ? o[0] : r.__k && C(r, 0), c, l), o && o.some(_)), c && D != "textarea" || (f = "value", D == "progress" && x == null ? t.removeAttribute(f) : x == null || x === t[f] && (D != "progress" || x) || te(t, f, x, T[f], a), f = "checked", S != null && S != t[f] && te(t, f, S, T[f], a));
	} else T === E || c && t.data == E || (t.data = E);
	return t;
}
function P(t, n, r, i) {
	try {
		typeof t == "function" ? n ? n.__x = t(n) || 1 : (i &&= i.__c || i.__e) && (n = i.__x) && (i.__x = null, typeof n == "function" ? n() : t(null)) : t.current = n;
	} catch (t) {
		e.__e(t, r);
	}
}
function oe(t, n, r) {
	var i, a, o, s;
	if (e.unmount && e.unmount(t), !(i = t.ref) || i.current && i.current != t.__e || P(i, null, n, t), i = t.__c) {
		if (i.componentWillUnmount) try {
			i.componentWillUnmount();
		} catch (t) {
			e.__e(t, n);
		}
		i.__P = i.__n = null;
	}
	if (i = t.__k) for (s = 0; s < i.length; s++) i[s] && oe(i[s], n, typeof t.type != "function" || r && !t.props.__P);
	!r && (i = t.__c) && (i = i.__z) && (a = ie(i, o = [])) && (i == t.__e && o.some(_), _(a), _(i)), r || _(t.__e), t.__e = t.__c = t.__ = null;
}
function se(e, t, n) {
	return this.constructor(e, n);
}
function F(t, n) {
	var r, i, a, o;
	e.__ && e.__(t, n), n.nodeType == 9 && (n = n.documentElement), i = (r = t && 32 & t.__u) ? null : n.__k, n.__k = y(x, { children: [t] }), a = [], o = [], re(n, n.__k, i || d, d, n.namespaceURI, i ? null : n.firstChild ? h.call(n.childNodes) : null, a, i ? i.__e : n.firstChild, r, o), M(a, n.__k, o), n.__k.props.children = null;
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
var ce = (e) => /^[^.[]*(?:\[[^\]]*\])?/.exec(e)[0], le = 5.5, ue = 35 * Math.PI / 180;
function de(e, t) {
	return {
		x0: e.x0 - t,
		y0: e.y0 - t,
		x1: e.x1 + t,
		y1: e.y1 + t
	};
}
function fe(e, [t, n]) {
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
function pe(e, t) {
	let n = Math.hypot(e, t), r = -t / n, i = e / n;
	return (Math.abs(e) >= Math.abs(t) ? i > 0 : r < 0) ? [r + 0, i + 0] : [-r + 0, -i + 0];
}
function me(e, t, n, r, i = 0) {
	let a = r[0] - n[0], o = r[1] - n[1], s = Math.hypot(a, o);
	if (s === 0) return {
		tail: n,
		head: r,
		barb: [r, r]
	};
	let [c, l] = pe(a, o), u = [n[0] + i * c, n[1] + i * l], d = [r[0] + i * c, r[1] + i * l], f = fe(de(e, le), [u, d]), p = fe(de(t, le), [u, d]), m = f ? f[1] : 0, h = p ? p[0] : 1;
	h <= m && (m = .35, h = .65);
	let g = [u[0] + m * a, u[1] + m * o], _ = [u[0] + h * a, u[1] + h * o], v = a / s, y = o / s, b = Math.min(11, .5 * s * (h - m)), x = b * Math.cos(ue), S = b * Math.sin(ue);
	return {
		tail: g,
		head: _,
		barb: [_, [_[0] - x * v + S * c, _[1] - x * y + S * l]]
	};
}
function he(e, t) {
	let n = e.head[0] - e.tail[0], r = e.head[1] - e.tail[1];
	if (n === 0 && r === 0) return [e.head, e.head];
	let [i, a] = pe(n, r), [o, s] = t ? e.head : e.tail, c = 15 / 2;
	return [[o + c * i, s + c * a], [o - c * i, s - c * a]];
}
var ge = /* @__PURE__ */ new Set([..."iljI|.,:;'!()[]{}/\\ ·‹›-ftr\"²³°"]), _e = /* @__PURE__ */ new Set([..."mwMW@%…+=<>~ΩQOGD&→δ_"]);
function ve(e, t, n = !1) {
	let r = 0;
	for (let t of e) ge.has(t) ? r += .42 : _e.has(t) ? r += .88 : t !== t.toLowerCase() && t === t.toUpperCase() ? r += .7 : r += (t.codePointAt(0) ?? 0) < 11904 ? .64 : 1.05;
	return r * t * (n ? 1.1 : 1);
}
var ye = .73;
function be(e, t, [n, r]) {
	let i = Math.max(ve(e, 19, !0) / 2, 6);
	t && (i += 6);
	let a = {
		x0: n - i,
		y0: r - ye * 19 / 2 - 1,
		x1: n + i,
		y1: r + ye * 19 / 2 + (t ? 3 : 1)
	};
	return t ? de(a, 2) : a;
}
function xe(e, t) {
	let n = /* @__PURE__ */ new Set();
	for (let [r, i] of t) {
		let t = r - e[0], a = i - e[1];
		Math.abs(a) >= .3 * Math.abs(t) && n.add(a > 0 ? "s" : "n"), Math.abs(t) >= .3 * Math.abs(a) && n.add(t > 0 ? "e" : "w");
	}
	return n;
}
// src/quantities.ts
function Se(e, t = 4) {
	if (e === null) return "—";
	if (e === 0) return "0";
	let n = Math.abs(e);
	return n >= 1e5 || n < .001 ? e.toExponential(t - 1) : String(+e.toPrecision(t));
}
var Ce = [
	[1e9, "G"],
	[1e6, "M"],
	[1e3, "k"],
	[1, ""],
	[.001, "m"],
	[1e-6, "µ"],
	[1e-9, "n"],
	[1e-12, "p"]
];
function I(e) {
	return e.replaceAll("*", "·");
}
function L(e) {
	return e.endsWith("/s") ? e.slice(0, -2) : e && `${e}*s`;
}
function R(e, t, n = 4) {
	if (e === null) return "—";
	if (e === 0 || !/^[A-Za-zΩ]+$/.test(t) || t === "kg") return `${Se(e, n)} ${I(t)}`.trim();
	let [r, i] = Ce.find(([t]) => Math.abs(e) >= t * (1 - 1e-9)) ?? Ce[Ce.length - 1];
	return `${+(e / r).toPrecision(n)} ${i}${t}`.trim();
}
// node_modules/preact/jsx-runtime/dist/jsxRuntime.mjs
var we = Symbol.for("pv"), Te = 0;
Array.isArray;
function z(t, n, r, i, a, o) {
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
		constructor: we,
		__v: --Te,
		__i: -1,
		__u: 0
	};
	return (a || o) && (u.__source = a, u.__self = o), e.vnode && e.vnode(u), u;
}
// src/shapes.tsx
var Ee = [100, 84];
function De(e, t) {
	return [e * Ee[0], t * Ee[1]];
}
var Oe = 18;
function ke(e, t) {
	return (e.ports ?? []).map((n, r) => {
		let [i, a] = t.get(`${e.name}.${n}`) ?? [0, 0];
		return Math.abs(i) < 1 && Math.abs(a) < 1 ? r % 2 ? "e" : "w" : Math.abs(a) > 1.1 * Math.abs(i) ? a > 0 ? "s" : "n" : i > 0 ? "e" : "w";
	}).join("");
}
function Ae(e, t) {
	let n = e.ports ?? [], r = (e) => n.filter((n, r) => t[r] === e), i = (e) => Math.max(0, ...r(e).map((e) => ve(e, 9))), a = (e) => r(e).reduce((e, t) => e + ve(t, 9) + 10, 0), o = Math.max(r("e").length, r("w").length), s = Math.max(54, Math.min(150, ve(e.letters, 10.5) + 16), i("e") + i("w") + 26, a("n"), a("s")), c = o ? -(o - 1) * Oe / 2 : 0, l = o ? c - 15 : 4;
	return {
		half: s / 2,
		first: c,
		title: l,
		top: l - (r("n").length ? 27 : 15),
		bottom: (o ? -c + 11 : 12) + (r("s").length ? 13 : 0)
	};
}
function je(e, t) {
	let { half: n, first: r, top: i, bottom: a } = Ae(e, t), o = /* @__PURE__ */ new Map(), s = {
		e: 0,
		w: 0,
		n: 0,
		s: 0
	};
	return (e.ports ?? []).forEach((e, c) => {
		let l = t[c], u = s[l]++;
		if (l === "e" || l === "w") o.set(e, [l === "e" ? n : -n, r + u * Oe]);
		else {
			let r = [...t].filter((e) => e === l).length;
			o.set(e, [2 * n * (u + 1) / (r + 1) - n, l === "n" ? i : a]);
		}
	}), o;
}
function Me(e, t, n, r = "") {
	if (e.kind === "part") {
		let { half: t, top: i, bottom: a } = Ae(e, r);
		return {
			x0: n[0] - t,
			y0: n[1] + i,
			x1: n[0] + t,
			y1: n[1] + a
		};
	}
	return be(e.letters, t, n);
}
function Ne(e, t, n, r, i = "") {
	if (e.kind === "part") {
		let n = t.slice(ce(t).length + 1), a = je(e, i).get(n);
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
	return [r, Me(e, n, r, i)];
}
var Pe = ([[e, t], [n, r]]) => ({
	x1: e,
	y1: t,
	x2: n,
	y2: r
});
function Fe(e, t) {
	let [n, r] = Le(e);
	if (Math.abs(e.head[0] - e.tail[0]) >= Math.abs(e.head[1] - e.tail[1])) return {
		x: n,
		y: r + (t > 0 ? -6 : 17),
		"text-anchor": "middle"
	};
	let i = t * Math.min(7, Math.abs(e.head[1] - e.tail[1]) / 5);
	return {
		x: n - 9 * t,
		y: r + 4 - i,
		"text-anchor": t > 0 ? "end" : "start"
	};
}
function Ie(e) {
	let [t, n] = Ne(e.tail, e.bond.ends[0], e.tailControlled, [e.tx, e.ty], e.tailPorts), [r, i] = Ne(e.head, e.bond.ends[1], e.headControlled, [e.hx, e.hy], e.headPorts);
	return me(n, i, t, r, e.shift * 9);
}
function Le(e) {
	return [(e.tail[0] + e.head[0]) / 2, (e.tail[1] + e.head[1]) / 2];
}
function Re(e, t) {
	for (let n in e) if (e[n] !== t[n]) return !0;
	return !1;
}
var ze = class extends S {
	shouldComponentUpdate(e) {
		return Re(e, this.props);
	}
	render(e) {
		let t = Ie(e), n = e.drawn, r = (n?.off ? " off" : "") + (n?.conflict ? " conflict" : ""), [i, a] = Le(t), o = new Set(n?.late ?? []);
		return /* @__PURE__ */ z("g", {
			class: "bond" + (e.selected ? " selected" : "") + r,
			"data-bond": e.bond.key,
			"data-text": e.bond.text,
			children: [
				/* @__PURE__ */ z("line", {
					class: "reach",
					...Pe([t.tail, t.head])
				}),
				e.flow !== 0 && /* @__PURE__ */ z("line", {
					class: "power",
					...Pe(e.flow > 0 ? [t.tail, t.head] : [t.head, t.tail]),
					style: { strokeWidth: `${2 + 5 * Math.abs(e.flow)}px` }
				}),
				/* @__PURE__ */ z("line", {
					class: "line",
					...Pe([t.tail, t.head])
				}),
				/* @__PURE__ */ z("line", {
					class: "line barb",
					...Pe(t.barb)
				}),
				n?.strokes.map((e) => /* @__PURE__ */ z("line", {
					class: "stroke" + (o.has(e) ? " derivative" : ""),
					"data-end": e,
					...Pe(he(t, e))
				})),
				n?.dashed?.map((e) => /* @__PURE__ */ z("line", {
					class: "stroke dynamic" + (o.has(e) ? " derivative" : ""),
					"data-end": e,
					...Pe(he(t, e))
				})),
				n?.conflict && /* @__PURE__ */ z("path", {
					class: "cross",
					d: `M${i - 4.5},${a - 4.5}l9,9m0,-9l-9,9`
				})
			]
		});
	}
}, Be = class extends S {
	shouldComponentUpdate(e) {
		return Re(e, this.props);
	}
	render(e) {
		let t = Ie(e);
		return /* @__PURE__ */ z("g", {
			"data-values": e.bond.key,
			children: [/* @__PURE__ */ z("text", {
				class: "value",
				...Fe(t, 1),
				children: e.effort
			}), /* @__PURE__ */ z("text", {
				class: "value",
				...Fe(t, -1),
				children: e.rate
			})]
		});
	}
};
function Ve(e, t, n) {
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
function He(e, t, n) {
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
var Ue = class extends S {
	shouldComponentUpdate(e) {
		return Re(e, this.props);
	}
	render(e) {
		let { node: t, state: n } = e, r = n?.controlled ?? (!!t.machine || !!t.law), i = Me(t, r, [e.x, e.y], e.ports), a = "node" + (t.kind === "0" || t.kind === "1" ? " junction" : "") + (t.kind === "part" ? " part" : "") + (n?.off ? " off" : "") + (n?.derivative ? " derivative" : "") + (e.selected ? " selected" : "") + (e.target ? " target" : ""), o = n?.says ?? t.says, s = [
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
		], c = He(e, i, s.length), l = ye * 19 / 2, u = Ae(t, e.ports);
		return /* @__PURE__ */ z("g", {
			class: a,
			"data-node": t.name,
			transform: `translate(${e.x},${e.y})`,
			children: [
				t.kind === "part" ? /* @__PURE__ */ z(x, { children: [
					/* @__PURE__ */ z("rect", {
						class: "frame",
						x: -u.half,
						y: u.top,
						width: 2 * u.half,
						height: u.bottom - u.top,
						rx: 6
					}),
					/* @__PURE__ */ z("text", {
						class: "title",
						y: u.title,
						"text-anchor": "middle",
						children: t.letters
					}),
					[...je(t, e.ports)].map(([n, [r, i]], a) => /* @__PURE__ */ z("g", {
						class: "port",
						"data-port": `${t.name}.${n}`,
						children: [
							/* @__PURE__ */ z("circle", {
								class: "hit",
								cx: r,
								cy: i,
								r: 9
							}),
							/* @__PURE__ */ z("circle", {
								cx: r,
								cy: i,
								r: 3
							}),
							/* @__PURE__ */ z("text", {
								...Ve(e.ports[a], r, i),
								children: n
							})
						]
					}))
				] }) : /* @__PURE__ */ z(x, { children: [
					/* @__PURE__ */ z("rect", {
						class: "reach",
						x: i.x0 - e.x - 6,
						y: i.y0 - e.y - 6,
						width: i.x1 - i.x0 + 12,
						height: i.y1 - i.y0 + 12
					}),
					r && /* @__PURE__ */ z("rect", {
						class: "switch",
						x: i.x0 - e.x,
						y: i.y0 - e.y,
						width: i.x1 - i.x0,
						height: i.y1 - i.y0,
						rx: 6
					}),
					/* @__PURE__ */ z("text", {
						class: "letters",
						x: r ? -4 : 0,
						y: l,
						"text-anchor": "middle",
						children: t.letters
					}),
					r && /* @__PURE__ */ z("text", {
						class: "subscript",
						x: ve(t.letters, 19, !0) / 2 - 3.5,
						y: l + 3.5,
						children: "c"
					})
				] }),
				s.map((e, t) => /* @__PURE__ */ z("text", {
					class: e.role,
					x: c.x,
					y: c.y + 13 * t,
					"text-anchor": c.anchor,
					children: e.text.length > 24 ? e.text.slice(0, 23) + "…" : e.text
				})),
				e.selected && /* @__PURE__ */ z("g", {
					class: "handle",
					"data-handle": t.name,
					children: [
						/* @__PURE__ */ z("circle", {
							class: "hit",
							cx: i.x1 - e.x + 12,
							cy: i.y0 - e.y - 8,
							r: 14
						}),
						/* @__PURE__ */ z("circle", {
							cx: i.x1 - e.x + 12,
							cy: i.y0 - e.y - 8,
							r: 6
						}),
						/* @__PURE__ */ z("path", { d: `M${i.x1 - e.x + 9},${i.y0 - e.y - 5}l6,-6m-4,0h4v4` })
					]
				})
			]
		});
	}
}, We = (e) => e.map((e) => e.replace(/\[[^\]]*\]/g, "")).sort().join("|");
function Ge({ state: e, sight: t, gesture: n, moved: r }) {
	let i = e.look, a = e.cursor?.strokes ?? i.strokes, o = n?.kind === "drag" ? new Set(n.names) : null, s = /* @__PURE__ */ new Map(), c = /* @__PURE__ */ new Map();
	for (let e of i.view.nodes) {
		let [t, n] = De(e.x, e.y);
		s.set(e.name, o?.has(e.name) ? [t + r[0], n + r[1]] : [t, n]), c.set(e.name, e);
	}
	let l = (e) => a.nodes[e.name]?.controlled ?? (!!e.machine || !!e.law), u = /* @__PURE__ */ new Map(), d = /* @__PURE__ */ new Map();
	for (let e of i.view.bonds) {
		u.has(e.tail) || u.set(e.tail, []), u.has(e.head) || u.set(e.head, []), u.get(e.tail).push(s.get(e.head)), u.get(e.head).push(s.get(e.tail));
		let t = We(e.ends);
		d.set(t, [...d.get(t) ?? [], e.key]);
	}
	let f = /* @__PURE__ */ new Map();
	for (let e of i.view.bonds) for (let [t, n, r] of [[
		e.ends[0],
		e.tail,
		e.head
	], [
		e.ends[1],
		e.head,
		e.tail
	]]) {
		let [e, i] = f.get(t) ?? [0, 0], [a, o] = [s.get(n), s.get(r)];
		f.set(t, [e + o[0] - a[0], i + o[1] - a[1]]);
	}
	let p = /* @__PURE__ */ new Map();
	for (let e of i.view.nodes) e.kind === "part" && p.set(e.name, ke(e, f));
	let m = (e) => p.get(e) ?? "", h = e.cursor?.values, g = h ? Math.max(1e-300, ...Object.values(h).map((e) => Math.abs((e.e ?? 0) * (e.f ?? 0)))) : 1, _ = n?.kind === "wire" ? ce(n.target) : "", v = (t) => {
		let [n, r] = [c.get(t.tail), c.get(t.head)], [i, o] = [s.get(t.tail), s.get(t.head)], u = d.get(We(t.ends)), f = h?.[t.key];
		return {
			bond: t,
			tail: n,
			head: r,
			tx: i[0],
			ty: i[1],
			hx: o[0],
			hy: o[1],
			tailControlled: l(n),
			headControlled: l(r),
			tailPorts: m(t.tail),
			headPorts: m(t.head),
			shift: u.indexOf(t.key) - (u.length - 1) / 2,
			drawn: a.bonds[t.key] ?? a.bonds[`${t.ends[0]} -> ${t.ends[1]}`],
			selected: e.bonds.has(t.key),
			flow: e.flowing && f ? (f.e ?? 0) * (f.f ?? 0) / g : 0
		};
	};
	return /* @__PURE__ */ z(x, { children: [
		/* @__PURE__ */ z("defs", { children: [/* @__PURE__ */ z("pattern", {
			id: "dots",
			width: Ee[0] / 4,
			height: Ee[1] / 4,
			patternUnits: "userSpaceOnUse",
			patternTransform: `translate(${t.x},${t.y}) scale(${t.k})`,
			children: /* @__PURE__ */ z("circle", {
				cx: 0,
				cy: 0,
				r: .7,
				class: "dot"
			})
		}), /* @__PURE__ */ z("marker", {
			id: "signal",
			viewBox: "0 0 8 8",
			refX: 7,
			refY: 4,
			markerWidth: 7,
			markerHeight: 7,
			orient: "auto",
			children: /* @__PURE__ */ z("path", {
				d: "M0,1L8,4L0,7z",
				class: "signalhead"
			})
		})] }),
		t.k > .45 && /* @__PURE__ */ z("rect", {
			class: "paper",
			width: "100%",
			height: "100%",
			fill: "url(#dots)"
		}),
		/* @__PURE__ */ z("g", {
			transform: `translate(${t.x},${t.y}) scale(${t.k})`,
			children: [
				i.view.modulations.map((e) => {
					let t = c.get(e.from), n = c.get(e.to);
					if (!t || !n) return null;
					let [r, i] = [s.get(e.from), s.get(e.to)], a = me(Me(t, l(t), r, m(t.name)), Me(n, l(n), i, m(n.name)), r, i, 7);
					return /* @__PURE__ */ z("line", {
						class: "signal",
						x1: a.tail[0],
						y1: a.tail[1],
						x2: a.head[0],
						y2: a.head[1],
						"marker-end": "url(#signal)"
					});
				}),
				/* @__PURE__ */ z("g", { children: i.view.bonds.map((e) => /* @__PURE__ */ z(ze, { ...v(e) }, e.key)) }),
				/* @__PURE__ */ z("g", { children: i.view.nodes.map((t) => /* @__PURE__ */ z(Ue, {
					node: t,
					x: s.get(t.name)[0],
					y: s.get(t.name)[1],
					state: a.nodes[t.name],
					selected: e.nodes.has(t.name),
					ports: m(t.name),
					target: _ === t.name || e.bondFrom === t.name,
					taken: [...xe(s.get(t.name), u.get(t.name) ?? [])].sort().join("")
				}, t.name)) }),
				h && t.k > .6 && /* @__PURE__ */ z("g", { children: i.view.bonds.map((e) => {
					let t = h[e.key];
					return t && /* @__PURE__ */ z(Be, {
						...v(e),
						effort: R(t.e, t.units[0]),
						rate: R(t.f, t.units[1])
					}, e.key);
				}) }),
				n?.kind === "wire" && /* @__PURE__ */ z(qe, {
					from: Ke(n.from, c, s, p),
					to: n.now
				}),
				n?.kind === "box" && /* @__PURE__ */ z("rect", {
					class: "marquee",
					x: Math.min(n.start[0], n.now[0]),
					y: Math.min(n.start[1], n.now[1]),
					width: Math.abs(n.now[0] - n.start[0]),
					height: Math.abs(n.now[1] - n.start[1])
				})
			]
		})
	] });
}
function Ke(e, t, n, r) {
	let i = ce(e);
	return Ne(t.get(i), e, !1, n.get(i), r.get(i))[0];
}
function qe({ from: e, to: t }) {
	return /* @__PURE__ */ z("line", {
		class: "wire",
		x1: e[0],
		y1: e[1],
		x2: t[0],
		y2: t[1]
	});
}
// src/overlays.tsx
function Je({ store: e, state: t }) {
	let { event: n, step: r } = t.instant, i = n.steps[r], a = r < n.steps.length - 1 ? "values before" : "values after";
	return /* @__PURE__ */ z("div", {
		class: "wiretext instant " + i.kind,
		role: "status",
		children: [
			/* @__PURE__ */ z("button", {
				"aria-label": "Mode before",
				disabled: r === 0,
				onClick: () => e.showInstant(n, r - 1),
				children: "◂"
			}),
			"t = ",
			R(n.t, "s"),
			", mode ",
			r + 1,
			" of ",
			n.steps.length,
			": ",
			/* @__PURE__ */ z("b", { children: i.kind }),
			" ",
			/* @__PURE__ */ z("small", { children: [
				"(",
				a,
				")"
			] }),
			/* @__PURE__ */ z("button", {
				"aria-label": "Mode after",
				disabled: r + 1 === n.steps.length,
				onClick: () => e.showInstant(n, r + 1),
				children: "▸"
			})
		]
	});
}
function Ye(e, t, [n, r]) {
	let i, a = Infinity;
	for (let o of e) {
		let e = (o.x - t.x) * n + (o.y - t.y) * r, s = Math.abs((o.x - t.x) * r - (o.y - t.y) * n);
		if (e <= .01) continue;
		let c = e + 2.5 * s;
		c < a && ([i, a] = [o, c]);
	}
	return i;
}
function Xe({ state: e, sight: t, size: n }) {
	let r = e.look.view.nodes;
	if (r.length < 25) return null;
	let i = r.map((e) => e.x), a = r.map((e) => e.y), [o, s] = [Math.min(...i) - 1, Math.min(...a) - 1], [c, l] = [Math.max(...i) + 2 - o, Math.max(...a) + 2 - s], u = {
		x: -t.x / t.k / Ee[0],
		y: -t.y / t.k / Ee[1]
	};
	return /* @__PURE__ */ z("svg", {
		class: "minimap",
		viewBox: `${o} ${s} ${c} ${l}`,
		"aria-hidden": "true",
		children: [r.map((e) => /* @__PURE__ */ z("circle", {
			cx: e.x,
			cy: e.y,
			r: c / 90
		})), /* @__PURE__ */ z("rect", {
			x: u.x,
			y: u.y,
			width: n[0] / t.k / Ee[0],
			height: n[1] / t.k / Ee[1]
		})]
	});
}
// src/keys.ts
var Ze = {
	ArrowLeft: [-1, 0],
	ArrowRight: [1, 0],
	ArrowUp: [0, -1],
	ArrowDown: [0, 1]
};
function Qe(e, t, n) {
	let { state: r } = t, i = r.look?.view.nodes ?? [], a = e.ctrlKey || e.metaKey, o = r.nodes.size === 1 ? i.find((e) => r.nodes.has(e.name)) : void 0, s = Ze[e.key];
	if (s && e.altKey && r.nodes.size) {
		let a = e.shiftKey ? .25 : 1, o = {};
		for (let e of i) r.nodes.has(e.name) && (o[e.name] = [e.x + a * s[0], e.y + a * s[1]]);
		n.place(o), t.edit({
			do: "move",
			at: o
		});
	} else if (s && !a) {
		let e = o ?? i[0];
		if (!e) return;
		let n = o ? Ye(i, o, s) : e;
		n && t.set({
			nodes: /* @__PURE__ */ new Set([n.name]),
			bonds: /* @__PURE__ */ new Set(),
			tab: "item"
		});
	} else if (e.key === "Tab" && !a) return;
	else if ((e.key === "[" || e.key === "]") && r.look) {
		let n = r.look.view.bonds.filter((e) => !o || e.tail === o.name || e.head === o.name), i = n.length ? n : r.look.view.bonds, a = i[(i.findIndex((e) => r.bonds.has(e.key)) + (e.key === "]" ? 1 : -1) + i.length) % i.length];
		a && t.set({
			bonds: /* @__PURE__ */ new Set([a.key]),
			tab: "item"
		});
	} else if (e.key === "Escape") t.set({
		nodes: /* @__PURE__ */ new Set(),
		bonds: /* @__PURE__ */ new Set(),
		bondFrom: null,
		cursor: null,
		instant: null,
		adding: !1,
		finding: !1
	});
	else if (e.key === "Enter" && r.bondFrom && o && o.name !== r.bondFrom) t.bond(r.bondFrom, o.name);
	else if (e.key === "Enter" && o) n.enter(o.name);
	else if (e.key === "b" && !a && o) t.set({ bondFrom: o.name });
	else if (e.key === "r" && !a && r.bonds.size) t.reverse();
	else if (e.key === "a" && !a) t.set({ adding: !0 });
	else if (e.key === "/" && !a) t.set({ finding: !0 });
	else if (e.key === "f" && !a) n.fit();
	else if ((e.key === "+" || e.key === "=") && !a) n.zoom(1.25);
	else if (e.key === "-" && !a) n.zoom(.8);
	else if (e.key === "a" && a) t.set({ nodes: new Set(i.map((e) => e.name)) });
	else if (e.key === "d" && a) t.duplicate();
	else if (e.key === "Delete" || e.key === "Backspace") t.remove();
	else if (e.key === "PageUp" && r.level) t.open(r.level.split(/\.(?![^[]*\])/).slice(0, -1).join("."));
	else return;
	e.preventDefault();
}
// src/sight.ts
var [$e, et] = [.05, 6];
function tt(e, t, n) {
	if (!e.length || !t) return {
		x: t / 2,
		y: n / 2,
		k: 1
	};
	let r = e.map((e) => e.x * Ee[0]), i = e.map((e) => e.y * Ee[1]), [a, o] = [Math.min(...r) - 90, Math.max(...r) + 90], [s, c] = [Math.min(...i) - 60, Math.max(...i) + 70], l = Math.min(1.5, t / (o - a), n / (c - s));
	return {
		k: l,
		x: t / 2 - l * (a + o) / 2,
		y: n / 2 - l * (s + c) / 2
	};
}
function nt({ x: e, y: t, k: n }, r, [i, a]) {
	let o = Math.max($e, Math.min(et, n * r));
	return {
		k: o,
		x: i - (i - e) * o / n,
		y: a - (a - t) * o / n
	};
}
function rt(e, [t, n], [r, i]) {
	let a = Math.hypot(t[0] - n[0], t[1] - n[1]), o = Math.hypot(r[0] - i[0], r[1] - i[1]), s = Math.max($e, Math.min(et, e.k * o / Math.max(a, 1))), [c, l] = [(r[0] + i[0]) / 2, (r[1] + i[1]) / 2], [u, d] = [(t[0] + n[0]) / 2, (t[1] + n[1]) / 2];
	return {
		k: s,
		x: c - (u - e.x) * s / e.k,
		y: l - (d - e.y) * s / e.k
	};
}
// src/canvas.tsx
var it = class extends S {
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
			let [t, n] = De(e.x, e.y), [i, c] = [a + s * t, o + s * n];
			return i < 40 || c < 40 || i > r.width - 40 || c > r.height - 40;
		}) && i.length) {
			if (!this.touched) this.fit();
			else {
				let [e, t] = De(i[0].x, i[0].y);
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
		let t = `${e.file}:${e.view.path}:${this.props.state.arranged}`;
		this.fitted !== t && e.view.nodes.length && (this.fitted = t, this.touched = !1, this.fit());
	}
	fit = () => {
		let e = this.props.state.look?.view.nodes ?? [], t = this.svg.current;
		if (!t) return;
		let n = t.getBoundingClientRect();
		this.setState({ sight: tt(e, n.width, n.height) });
	};
	zoom(e, t) {
		this.touched = !0;
		let n = this.svg.current.getBoundingClientRect();
		this.setState({ sight: nt(this.state.sight, e, t ?? [n.width / 2, n.height / 2]) });
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
			if (e && ce(e) !== t) return e;
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
				let [e, r] = t.ids.map((e) => this.pointers.get(e));
				this.setState({
					sight: rt(n, t.last, [e, r]),
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
					let n = this.under(e, ce(t.from));
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
						let t = e.x + n[0] / Ee[0], r = e.y + n[1] / Ee[1];
						o[e.name] = [Math.round(t / a) * a, Math.round(r / a) * a];
					}
					this.place(o), r.edit({
						do: "move",
						at: o
					});
				} else if (t.kind === "box") {
					let [e, n] = [t.start[0], t.now[0]].sort((e, t) => e - t), [a, o] = [t.start[1], t.now[1]].sort((e, t) => e - t), s = i.look.view.nodes.filter((t) => {
						let [r, i] = De(t.x, t.y);
						return r >= e && r <= n && i >= a && i <= o;
					}).map((e) => e.name);
					s.length && r.set({ nodes: new Set(t.add ? [...i.nodes, ...s] : s) });
				} else if (t.kind === "wire") {
					let n = this.under(e, ce(t.from)) || t.target;
					n ? r.bond(t.from, n) : Math.hypot(...at(this.local(e), t.start)) < 8 && r.set({ bondFrom: t.from });
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
	enter(e) {
		let { store: t, state: n } = this.props, r = n.look?.view.nodes.find((t) => t.name === e);
		r?.kind === "part" && r.known ? t.open(n.level ? `${n.level}.${e}` : e) : (t.set({ tab: "item" }), requestAnimationFrame(() => document.querySelector(".side [data-first]")?.focus()));
	}
	key = (e) => Qe(e, this.props.store, this);
	dropped = (e) => {
		let t = e.dataTransfer?.getData("application/x-hybond");
		if (!t) return;
		e.preventDefault();
		let { element: n, stem: r } = JSON.parse(t), [i, a] = this.inGraph(this.local(e));
		this.props.store.add(n, r, [Math.round(i / Ee[0] * 4) / 4, Math.round(a / Ee[1] * 4) / 4]);
	};
	render({ state: e, store: t }, { sight: n, gesture: r, moved: i }) {
		let a = e.look;
		return a ? /* @__PURE__ */ z("div", {
			class: "canvas",
			onDragOver: (e) => e.preventDefault(),
			onDrop: this.dropped,
			children: [
				/* @__PURE__ */ z("svg", {
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
					children: /* @__PURE__ */ z(Ge, {
						state: e,
						sight: n,
						gesture: r,
						moved: i
					})
				}),
				r?.kind === "wire" && /* @__PURE__ */ z("div", {
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
				e.instant && /* @__PURE__ */ z(Je, {
					store: t,
					state: e
				}),
				e.bondFrom && /* @__PURE__ */ z("div", {
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
				/* @__PURE__ */ z("div", {
					class: "views",
					children: [
						/* @__PURE__ */ z("button", {
							title: "Zoom in (+)",
							"aria-label": "Zoom in",
							onClick: () => this.zoom(1.25),
							children: "+"
						}),
						/* @__PURE__ */ z("button", {
							title: "Zoom out (-)",
							"aria-label": "Zoom out",
							onClick: () => this.zoom(.8),
							children: "−"
						}),
						/* @__PURE__ */ z("button", {
							title: "Show all (f)",
							"aria-label": "Show all",
							onClick: this.fit,
							children: "⤢"
						})
					]
				}),
				/* @__PURE__ */ z(Xe, {
					state: e,
					sight: n,
					size: this.size
				}),
				a.view.crumbs.length > 0 && /* @__PURE__ */ z("nav", {
					class: "crumbs",
					"aria-label": "Submodel",
					children: [
						/* @__PURE__ */ z("button", {
							onClick: () => t.open(""),
							children: a.title || a.file
						}),
						a.view.crumbs.map((e, n) => /* @__PURE__ */ z(x, { children: [" › ", /* @__PURE__ */ z("button", {
							onClick: () => t.open(a.view.crumbs.slice(0, n + 1).join(".")),
							children: e
						})] })),
						!a.view.editable && /* @__PURE__ */ z("span", { children: [
							" (",
							a.view.name,
							", a ready part: to look at)"
						] })
					]
				})
			]
		}) : /* @__PURE__ */ z("div", { class: "canvas" });
	}
}, at = (e, t) => [e[0] - t[0], e[1] - t[1]], ot, B, st, ct, lt = Object.is, ut = 0, dt = [], ft = [], pt = e, mt = pt.__b, ht = pt.__r, gt = pt.diffed, _t = pt.__c, vt = pt.unmount, yt = pt.__;
function bt(e, t) {
	pt.__h && pt.__h(B, e, ut || t), ut = 0;
	var n = B.__H || (B.__H = {
		__: [],
		__h: []
	});
	return e >= n.__.length && n.__.push({}), n.__[e];
}
function V(e) {
	return ut = 1, xt(jt, e);
}
function xt(e, t, n) {
	var r = bt(ot++, 2);
	if (r.t = e, !r.__c && (r.__ = [n ? n(t) : jt(void 0, t), function(e) {
		var t = (r.__N || r.__)[0], n = r.t(t, e);
		lt(t, n) || (r.__N = [n, r.__[1]], r.__c.setState({}));
	}], r.__c = B, !B.__f)) {
		B.__f = !0;
		var i = B.shouldComponentUpdate;
		B.shouldComponentUpdate = function(e, t, n) {
			var r = this.__H;
			if (!r) return !0;
			var a = !1, o = this.props != e;
			if (r.__.some(function(e) {
				e.__N && (a = !0, lt(e.__[0], e.__N[0]) || (o = !0));
			}), i) {
				var s = i.call(this, e, t, n);
				return a ? s || o : s;
			}
			return !a || o;
		};
	}
	return r.__;
}
function H(e, t) {
	var n = bt(ot++, 3);
	!pt.__s && At(n.__H, t) && (n.__P = !0, n.__ = e, n.u = t, B.__H.__h.push(n));
}
function St(e) {
	return ut = 5, Ct(function() {
		return { current: e };
	}, []);
}
function Ct(e, t) {
	var n = bt(ot++, 7);
	return At(n.__H, t) && (n.__ = e(), n.__H = t), n.__;
}
function wt() {
	var e;
	do {
		for (; e = ft.shift();) try {
			Ot(e);
		} catch (t) {
			pt.__e(t, { __: (e = e.__P) && e.__v });
		}
		for (; e = dt.shift();) {
			var t = e.__H;
			if (e.__P && t) try {
				t.__h.some(Ot), t.__h.some(kt), t.__h = [];
			} catch (n) {
				t.__h = [], pt.__e(n, e.__v);
			}
		}
	} while (ft.length);
}
pt.__b = function(e) {
	B = null, mt && mt(e);
}, pt.__ = function(e, t) {
	e && t.__k && t.__k.__m && (e.__m = t.__k.__m), yt && yt(e, t);
}, pt.__r = function(e) {
	ht && ht(e), ot = 0;
	var t = (B = e.__c).__H;
	t && (st == B ? B.__h = [] : (t.__h.some(Ot), t.__h.some(kt), ot = 0), t.__h = [], t.__.some(function(e) {
		e.__N && (e.__ = e.__N), e.u = e.__N = void 0;
	})), st = B;
}, pt.diffed = function(e) {
	gt && gt(e);
	var t = e.__c;
	t && t.__H && (t.__H.__h.length && Dt(dt.push(t)), t.__H.__.some(function(e) {
		e.u && (e.__H = e.u);
	})), st = B = null;
}, pt.__c = function(e, t) {
	t.some(function(e) {
		try {
			e.__h.some(Ot), e.__h = e.__h.filter(function(e) {
				return !e.__ || kt(e);
			});
		} catch (t) {
			e.__h = [function() {
				throw t;
			}];
		}
	}), _t && _t(e, t);
}, pt.unmount = function(e) {
	vt && vt(e);
	var t, n, r = e.__c;
	r && r.__H && (r.__H.__.some(function(r) {
		try {
			if (r.__P && r.__c) {
				if (n === void 0) {
					for (n = e.__; n && (!n.__c || !n.__c.__P);) n = n.__;
					n &&= n.__c;
				}
				r.__P = n, Dt(ft.push(r));
			} else Ot(r);
		} catch (e) {
			t = e;
		}
	}), r.__H = void 0, t && pt.__e(t, r.__v));
};
var Tt = typeof requestAnimationFrame == "function";
function Et(e) {
	var t, n = function() {
		clearTimeout(r), Tt && cancelAnimationFrame(t), setTimeout(e);
	}, r = setTimeout(n, 35);
	Tt && (t = requestAnimationFrame(n));
}
function Dt(e) {
	e != 1 && ct == pt.requestAnimationFrame || ((ct = pt.requestAnimationFrame) || Et)(wt);
}
function Ot(e) {
	var t = B, n = e.__c;
	typeof n == "function" && (e.__c = void 0, n()), B = t;
}
function kt(e) {
	var t = B;
	e.__c = e.__(), B = t;
}
function At(e, t) {
	return !e || e.length != t.length || t.some(function(t, n) {
		return !lt(t, e[n]);
	});
}
function jt(e, t) {
	return typeof t == "function" ? t(e) : t;
}
// src/events.tsx
var Mt = 100;
function Nt({ store: e, state: t }) {
	let [n, r] = V([]), [i, a] = V(0), [o, s] = V(0), c = t.run;
	H(() => s(0), [c?.run]), H(() => {
		if (!c || c.tEnd === void 0) return r([]);
		let t = !1;
		return e.transport.ask("events", {
			run: c.run,
			first: o,
			count: Mt
		}).then((e) => {
			t || (r(e.events), a(e.total));
		}).catch((t) => e.refused(t)), () => {
			t = !0;
		};
	}, [c?.run, o]);
	let l = t.instant?.event.event;
	return /* @__PURE__ */ z("section", {
		class: "events",
		tabindex: 0,
		"aria-label": "Events",
		children: [
			c && c.tEnd !== void 0 && /* @__PURE__ */ z("p", {
				class: "status " + c.status,
				children: [
					c.status === "ok" ? "ok" : /* @__PURE__ */ z("b", { children: c.status }),
					", ",
					i,
					" events, ",
					R(c.took, "s"),
					c.method ? `, ${c.method}` : ""
				]
			}),
			c?.warnings?.map((e) => /* @__PURE__ */ z("p", {
				class: "warning",
				children: e
			})),
			i > Mt && /* @__PURE__ */ z("p", { children: [
				/* @__PURE__ */ z("button", {
					disabled: o === 0,
					onClick: () => s(Math.max(0, o - Mt)),
					children: "◂"
				}),
				" ",
				o + 1,
				" to ",
				Math.min(o + Mt, i),
				" of ",
				i,
				" ",
				/* @__PURE__ */ z("button", {
					disabled: o + Mt >= i,
					onClick: () => s(o + Mt),
					children: "▸"
				})
			] }),
			/* @__PURE__ */ z("ol", { children: n.map((n) => /* @__PURE__ */ z("li", {
				class: n.event === l ? "open" : "",
				children: [/* @__PURE__ */ z("button", {
					"data-event": n.event,
					"aria-expanded": n.event === l,
					onClick: () => e.showInstant(n, 0),
					children: [
						/* @__PURE__ */ z("b", { children: R(n.t, "s") }),
						" ",
						/* @__PURE__ */ z("i", { children: n.cause }),
						" ",
						n.steps.flatMap((e) => e.fired).map((e) => `${e.machine}: ${e.source} → ${e.target}`).join("; "),
						n.steps.some((e) => e.kind !== "continuous") && /* @__PURE__ */ z("em", { children: [" ", Pt(n)] })
					]
				}), n.event === l && /* @__PURE__ */ z(Ft, {
					store: e,
					state: t,
					event: n
				})]
			})) })
		]
	});
}
function Pt(e) {
	let t = (t) => e.steps.filter((e) => e.kind === t).length;
	return [[t("mythical"), "mythical"], [t("pinnacle"), "pinnacle"]].filter(([e]) => e).map(([e, t]) => e === 1 ? t : `${e} ${t}`).join(", ");
}
function Ft({ store: e, state: t, event: n }) {
	let r = t.instant.step, i = n.steps[r];
	return /* @__PURE__ */ z("div", {
		class: "detail",
		children: [
			/* @__PURE__ */ z("div", {
				class: "row",
				children: n.steps.map((t, i) => /* @__PURE__ */ z("button", {
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
			/* @__PURE__ */ z("p", { children: [
				"mode: ",
				Object.entries(i.mode).map(([e, t]) => `${e} = ${t}`).join(", ") || "the only one",
				i.kind === "mythical" && " (lasts no time, stores nothing)",
				i.kind === "pinnacle" && " (lasts no time, writes the state)"
			] }),
			i.fired.map((e) => /* @__PURE__ */ z("p", {
				class: "fired",
				children: [
					/* @__PURE__ */ z("b", { children: e.machine }),
					": ",
					e.source,
					" → ",
					e.target,
					", because ",
					/* @__PURE__ */ z("code", { children: e.why })
				]
			})),
			Object.keys(i.impulses).length > 0 && /* @__PURE__ */ z("p", { children: [
				"impulses",
				i.kind === "mythical" ? " (on trial)" : "",
				":",
				" ",
				Object.entries(i.impulses).map(([e, t]) => `${e} = ${Se(t, 6)} δ`).join(", ")
			] }),
			i.energy && /* @__PURE__ */ z("p", { children: [
				"energy ",
				i.energy.before,
				" → ",
				i.energy.after,
				"; supplied ",
				i.energy.source,
				", lost ",
				i.energy.lost
			] }),
			i.undetermined.length > 0 && /* @__PURE__ */ z("p", { children: ["not determined: ", i.undetermined.join(", ")] })
		]
	});
}
// src/quick.tsx
function It({ title: e, ask: t, placeholder: n, most: r, fitting: i, say: a, none: o, take: s, close: c }) {
	let [l, u] = V(""), [d, f] = V(0), p = i(l), m = Math.min(p.length, r) - 1, h = () => {
		document.querySelector(".canvas svg")?.focus(), c();
	}, g = async (e) => {
		await s(e, l) && h();
	};
	return /* @__PURE__ */ z("div", {
		class: "quick",
		role: "dialog",
		"aria-label": e,
		children: [/* @__PURE__ */ z("input", {
			ref: (e) => e?.focus(),
			value: l,
			"aria-label": t,
			placeholder: n,
			onInput: (e) => {
				u(e.currentTarget.value), f(0);
			},
			onKeyDown: (e) => {
				let t = {
					ArrowDown: 1,
					ArrowUp: -1
				}[e.key];
				t && (f(Math.max(0, Math.min(d + t, m))), e.preventDefault()), e.key === "Enter" && g(p[Math.min(d, m)]), e.key === "Escape" && h(), e.stopPropagation();
			}
		}), /* @__PURE__ */ z("ul", { children: [
			p.slice(0, r).map((e, t) => /* @__PURE__ */ z("li", {
				class: t === d ? "chosen" : "",
				onClick: () => void g(e),
				children: a(e)
			})),
			p.length > r && /* @__PURE__ */ z("li", { children: [p.length - r, " more"] }),
			o && l.trim() && !p.length && /* @__PURE__ */ z("li", { children: o })
		] })]
	});
}
// src/find.tsx
var Lt = 10, Rt = (e) => e.toLowerCase().replaceAll(/[µμ]/g, "u").replaceAll(/[Ωω]/g, "ohm");
function zt(e, t) {
	let n = e.look?.view;
	if (!n || !t) return [];
	let r = (e, n) => e === t ? 0 : e.startsWith(t) ? 1 : e.includes(t) ? 2 : n.includes(t) ? 4 : 9, i = n.nodes.map((e) => {
		let t = e.kind === "part" ? String(e.entry.submodel ?? "") : [e.letters, e.says].filter(Boolean).join(" ");
		return {
			key: e.name,
			said: e.name,
			about: t,
			bond: !1,
			rank: r(e.name.toLowerCase(), Rt(t))
		};
	}), a = n.bonds.map((e) => ({
		key: e.key,
		said: e.text,
		about: "bond",
		bond: !0,
		rank: e.text.toLowerCase().includes(t) ? 3 : 9
	}));
	return [...i, ...a].filter((e) => e.rank < 9).sort((e, t) => e.rank - t.rank);
}
function Bt({ store: e, state: t }) {
	return /* @__PURE__ */ z(It, {
		title: "Find",
		ask: "What to find",
		placeholder: "a name, a kind, a value",
		most: Lt,
		fitting: (e) => zt(t, Rt(e.trim())),
		say: (e) => /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("b", { children: e.said }),
			" ",
			e.about
		] }),
		none: "nothing of that name at this level",
		take: (t) => (t && e.set({
			nodes: new Set(t.bond ? [] : [t.key]),
			bonds: new Set(t.bond ? [t.key] : []),
			tab: "item"
		}), t !== void 0),
		close: () => e.set({ finding: !1 })
	});
}
// src/formulas.tsx
var Vt = new Set("math mrow mi mo mn mtext mspace mfrac msub msup msubsup mover munder munderover msqrt mroot mtable mtr mtd mstyle".split(" "));
function Ht(e) {
	if (typeof e == "string") return e;
	let [t, n, ...r] = e, i = t === "math" ? { display: "block" } : {};
	return v(Vt.has(t) ? t : "mrow", {
		...n,
		...i
	}, ...r.map(Ht));
}
function Ut({ store: e, state: t }) {
	let [n, r] = V("all"), [i, a] = V(!1), [o, s] = V(null), c = t.look, l = t.cursor?.mode ?? Object.fromEntries(c.machines.map((e) => [e.path, e.state])), u = n === "mode" ? JSON.stringify(l) : "";
	return H(() => {
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
	]), /* @__PURE__ */ z("section", {
		class: "formulas",
		children: [
			/* @__PURE__ */ z("div", {
				class: "row",
				children: [[
					["all", "all modes"],
					["mode", "the mode drawn"],
					["structure", "structure"]
				].map(([e, t]) => /* @__PURE__ */ z("button", {
					"aria-pressed": n === e,
					onClick: () => r(e),
					children: t
				})), o?.formula && /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("input", {
					type: "checkbox",
					checked: i,
					onChange: (e) => a(e.currentTarget.checked)
				}), " as text"] })]
			}),
			!o && /* @__PURE__ */ z("p", {
				class: "hint",
				children: "…"
			}),
			o?.formula && !i ? /* @__PURE__ */ z("div", {
				class: "formula",
				tabindex: 0,
				role: "group",
				"aria-label": "Equations",
				children: Ht(o.formula)
			}) : o && /* @__PURE__ */ z("pre", {
				class: "equations",
				tabindex: 0,
				children: o.text
			}),
			o?.notes?.map((e) => /* @__PURE__ */ z("p", {
				class: "hint",
				children: e
			}))
		]
	});
}
// src/fields.tsx
var Wt = 0;
function U(e) {
	let [t, n] = V(e.value), [r] = V(() => `list${++Wt}`), i = St(!1);
	return H(() => {
		i.current || n(e.value);
	}, [e.value]), /* @__PURE__ */ z(x, { children: [/* @__PURE__ */ z("input", {
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
	}), e.list && /* @__PURE__ */ z("datalist", {
		id: r,
		children: e.list.map((e) => /* @__PURE__ */ z("option", { value: e }))
	})] });
}
function Gt(e) {
	let t = e.trim();
	return t === "" ? null : /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(t) ? Number(t) : t;
}
// src/item.tsx
var Kt = {
	C: ["q", "e"],
	I: ["p", "f"]
}, qt = {
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
function Jt({ store: e, state: t }) {
	let n = t.look, r = n.view.nodes.filter((e) => t.nodes.has(e.name)), i = n.view.bonds.filter((e) => t.bonds.has(e.key));
	if (r.length === 1) return /* @__PURE__ */ z($t, {
		store: e,
		state: t,
		node: r[0]
	});
	if (i.length === 1 && !r.length) {
		let r = i[0], a = t.cursor?.values[r.key];
		return /* @__PURE__ */ z("section", { children: [
			/* @__PURE__ */ z("h2", { children: "Bond" }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "written" }), /* @__PURE__ */ z(U, {
				label: "Bond",
				first: !0,
				value: r.text,
				disabled: !n.view.editable,
				onWrite: (n) => void Yt(e, t, r.key, n)
			})] }),
			a && /* @__PURE__ */ z("p", { children: [
				"effort ",
				R(a.e, a.units[0]),
				", flow ",
				R(a.f, a.units[1]),
				", power",
				" ",
				a.e === null || a.f === null ? "—" : R(a.e * a.f, "W")
			] }),
			/* @__PURE__ */ z("div", {
				class: "row",
				children: [/* @__PURE__ */ z("button", {
					onClick: () => e.reverse(),
					children: "Turn round (r)"
				}), /* @__PURE__ */ z("button", {
					onClick: () => e.remove(),
					children: "Delete"
				})]
			})
		] });
	}
	return r.length + i.length > 1 ? /* @__PURE__ */ z("section", { children: [/* @__PURE__ */ z("h2", { children: [
		r.length,
		" elements, ",
		i.length,
		" bonds"
	] }), /* @__PURE__ */ z("div", {
		class: "row",
		children: [
			/* @__PURE__ */ z("button", {
				onClick: () => Xt(e, r, "y"),
				children: "In a row"
			}),
			/* @__PURE__ */ z("button", {
				onClick: () => Xt(e, r, "x"),
				children: "In a column"
			}),
			/* @__PURE__ */ z("button", {
				disabled: r.length < 3,
				onClick: () => Zt(e, r, "x"),
				children: "Evenly across"
			}),
			/* @__PURE__ */ z("button", {
				disabled: r.length < 3,
				onClick: () => Zt(e, r, "y"),
				children: "Evenly down"
			}),
			/* @__PURE__ */ z("button", {
				onClick: () => void e.duplicate(),
				children: "Duplicate"
			}),
			/* @__PURE__ */ z("button", {
				onClick: () => e.remove(),
				children: "Delete"
			})
		]
	})] }) : /* @__PURE__ */ z(Qt, {
		store: e,
		state: t
	});
}
async function Yt(e, t, n, r) {
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
function Xt(e, t, n) {
	let r = t.reduce((e, t) => e + t[n], 0) / t.length, i = Math.round(r * 4) / 4, a = Object.fromEntries(t.map((e) => [e.name, n === "y" ? [e.x, i] : [i, e.y]]));
	e.edit({
		do: "move",
		at: a
	});
}
function Zt(e, t, n) {
	let r = [...t].sort((e, t) => e[n] - t[n]), [i, a] = [r[0][n], r[r.length - 1][n]], o = Object.fromEntries(r.map((e, t) => {
		let o = i + (a - i) * t / (r.length - 1);
		return [e.name, n === "x" ? [o, e.y] : [e.x, o]];
	}));
	e.edit({
		do: "move",
		at: o
	});
}
function Qt({ store: e, state: t }) {
	let n = t.look, r = t.stock?.domains ?? [], i = (t, n) => void e.edit({
		do: "set",
		path: t,
		value: n
	});
	return /* @__PURE__ */ z("section", { children: [
		/* @__PURE__ */ z("h2", { children: "Model" }),
		/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "title" }), /* @__PURE__ */ z(U, {
			label: "Title",
			first: !0,
			value: n.title,
			disabled: !n.view.editable,
			onWrite: (e) => i(["title"], e)
		})] }),
		/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "domain" }), /* @__PURE__ */ z("select", {
			disabled: !n.view.editable,
			value: n.view.domain,
			onChange: (e) => i(["domain"], e.currentTarget.value),
			children: r.map((e) => /* @__PURE__ */ z("option", {
				value: e.name,
				children: [
					e.name,
					" ",
					e.effort && `(${e.effort}, ${e.flow})`
				]
			}))
		})] }),
		/* @__PURE__ */ z("p", {
			class: "hint",
			children: [
				"Put elements down from the palette, or press ",
				/* @__PURE__ */ z("kbd", { children: "a" }),
				" and write ",
				/* @__PURE__ */ z("code", { children: "R load 10 ohm" }),
				". Drag from the handle of a selected element to bond it, or press ",
				/* @__PURE__ */ z("kbd", { children: "b" }),
				". Strokes follow each edit. ",
				/* @__PURE__ */ z("kbd", { children: "/" }),
				" finds a name."
			]
		})
	] });
}
function $t({ store: e, state: t, node: n }) {
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
	return /* @__PURE__ */ z("section", { children: [
		/* @__PURE__ */ z("h2", { children: n.kind === "part" ? String(i.submodel) : t.stock?.kinds.find((e) => e.kind === n.kind)?.about ?? n.kind }),
		/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "name" }), /* @__PURE__ */ z(U, {
			label: "Name",
			first: s || n.kind === "part",
			value: n.name,
			disabled: r,
			onWrite: o
		})] }),
		!s && n.kind !== "part" && /* @__PURE__ */ z(en, {
			node: n,
			off: r,
			set: a
		}),
		Kt[n.kind]?.map((e) => /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: ["start ", e] }), /* @__PURE__ */ z(U, {
			label: `Start value ${e}`,
			value: rn(i[e]),
			disabled: r,
			placeholder: "0",
			onWrite: (t) => a([e], Gt(t))
		})] })),
		s && /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "kind" }), /* @__PURE__ */ z("select", {
				disabled: r,
				value: n.kind,
				onChange: (e) => a(["junction"], Number(e.currentTarget.value)),
				children: [/* @__PURE__ */ z("option", {
					value: "0",
					children: "0, common effort"
				}), /* @__PURE__ */ z("option", {
					value: "1",
					children: "1, common flow"
				})]
			})] }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "law" }), /* @__PURE__ */ z("select", {
				disabled: r,
				value: rn(i.law),
				onChange: (e) => a(["law"], e.currentTarget.value || null),
				children: [/* @__PURE__ */ z("option", {
					value: "",
					children: "none"
				}), t.stock?.laws.map((e) => /* @__PURE__ */ z("option", {
					value: e,
					children: e
				}))]
			})] }),
			(qt[rn(i.law)] ?? []).map((e) => /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: e }), /* @__PURE__ */ z(U, {
				label: e,
				value: rn(i[e]),
				disabled: r,
				onWrite: (t) => a([e], Gt(t))
			})] })),
			/* @__PURE__ */ z(tn, {
				store: e,
				state: t,
				node: n
			})
		] }),
		n.kind === "part" && /* @__PURE__ */ z(x, { children: [
			c && /* @__PURE__ */ z("p", {
				class: "hint",
				children: c.title
			}),
			Object.entries({
				...c?.parameters,
				...i.parameters
			}).map(([e]) => {
				let t = i.parameters?.[e];
				return /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: e }), /* @__PURE__ */ z(U, {
					label: e,
					value: rn(t),
					disabled: r,
					placeholder: c?.parameters[e],
					onWrite: (t) => a(["parameters", e], Gt(t))
				})] });
			}),
			n.inputs?.map((e) => /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: [e, " ⟵"] }), /* @__PURE__ */ z(U, {
				label: `Input ${e}`,
				value: rn(i.inputs?.[e]),
				disabled: r,
				placeholder: "an expression",
				list: W(t),
				onWrite: (t) => a(["inputs", e], Gt(t))
			})] })),
			n.known && /* @__PURE__ */ z("button", {
				onClick: () => e.open(t.level ? `${t.level}.${n.name}` : n.name),
				children: "Open"
			})
		] }),
		/* @__PURE__ */ z("div", {
			class: "row",
			children: [
				/* @__PURE__ */ z("button", {
					disabled: r,
					onClick: () => e.set({ bondFrom: n.name }),
					children: "Bond (b)"
				}),
				/* @__PURE__ */ z("button", {
					disabled: r,
					onClick: () => void e.duplicate(),
					children: "Duplicate"
				}),
				/* @__PURE__ */ z("button", {
					disabled: r,
					onClick: () => e.remove(),
					children: "Delete"
				})
			]
		})
	] });
}
function en({ node: e, off: t, set: n }) {
	let r = e.entry[e.kind];
	if (typeof r == "object" && r && !Array.isArray(r)) {
		let [i, a] = Object.entries(r)[0] ?? ["e", ""];
		if (typeof a == "string") return /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: [i, " ="] }), /* @__PURE__ */ z(U, {
			label: `Law, ${i} =`,
			first: !0,
			value: a,
			disabled: t,
			onWrite: (t) => n([e.kind, i], t)
		})] });
	}
	return typeof r == "object" && r ? /* @__PURE__ */ z("p", {
		class: "hint",
		children: "A field or a table: edit it in the text."
	}) : /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "value" }), /* @__PURE__ */ z(U, {
		label: "Value",
		first: !0,
		value: rn(r),
		disabled: t,
		onWrite: (t) => {
			let r = /^\s*([ef])\s*=\s*(.+)$/.exec(t);
			n([e.kind], r ? { [r[1]]: r[2] } : Gt(t) ?? 1);
		}
	})] });
}
function tn({ store: e, state: t, node: n }) {
	let r = t.look;
	return n.machine ? /* @__PURE__ */ z("p", { children: ["switched by ", /* @__PURE__ */ z("button", {
		class: "link",
		onClick: () => e.set({ tab: "machines" }),
		children: n.machine
	})] }) : n.law ? null : /* @__PURE__ */ z("button", {
		disabled: !r.view.editable,
		onClick: () => void e.edit({
			do: "set",
			path: ["machines", nn(Object.keys(r.panels.machines), `${n.name}_switch`)],
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
function nn(e, t) {
	if (!e.includes(t)) return t;
	for (let n = 2;; n++) if (!e.includes(`${t}${n}`)) return `${t}${n}`;
}
function rn(e) {
	return e == null ? "" : typeof e == "object" ? JSON.stringify(e) : String(e);
}
function W(e) {
	let t = e.look;
	if (!t) return [];
	let n = ["time"];
	for (let e of t.view.nodes) n.push(`${e.name}.e`, `${e.name}.f`), e.kind === "C" && n.push(`${e.name}.q`), e.kind === "I" && n.push(`${e.name}.p`);
	return n.push(...Object.keys(t.panels.machines).map((e) => `${e}.state`), ...e.run?.names ?? []), n.push("pre", "abs", "min", "max", "sqrt", "sin", "cos", "exp", "and", "or", "not"), n.push(...t.view.signals.map((e) => e.name), ...Object.keys(t.panels.parameters)), [...new Set(n)];
}
// src/expression.tsx
var G = 250, an = /[A-Za-z_][\w.]*$/, on = 0;
function sn(e) {
	let [t, n] = V(e.value), [r, i] = V([]), [a, o] = V(-1), [s, c] = V(null), [l] = V(() => `words${++on}`), u = St(null), d = St(!1), f = St(0);
	H(() => {
		d.current || n(e.value), c(null);
	}, [e.value]);
	let p = () => {
		i([]), o(-1);
	}, m = () => {
		let t = u.current.value;
		n(t);
		let r = an.exec(t.slice(0, u.current.selectionStart ?? t.length))?.[0] ?? "", a = r.toLowerCase(), s = r ? e.words.filter((e) => e !== r && e.toLowerCase().includes(a)) : [];
		s.sort((e, t) => Number(t.toLowerCase().startsWith(a)) - Number(e.toLowerCase().startsWith(a))), i(s.slice(0, 8)), o(-1);
		let l = ++f.current;
		setTimeout(() => {
			l === f.current && e.check(t).then((e) => l === f.current && c(e)).catch(() => {});
		}, G);
	}, h = (e) => {
		let t = u.current, n = t.selectionStart ?? t.value.length, r = t.value.slice(0, n).replace(an, e);
		t.value = r + t.value.slice(n), t.setSelectionRange(r.length, r.length), p(), m(), i([]), t.focus();
	}, g = () => {
		d.current = !1, f.current++, p(), t !== e.value && e.onWrite(t);
	}, _ = (t) => {
		t.stopPropagation();
		let i = {
			ArrowDown: 1,
			ArrowUp: -1
		}[t.key];
		if (i && r.length) t.preventDefault(), o((a + i + r.length) % r.length);
		else if ((t.key === "Tab" || t.key === "Enter") && a >= 0) t.preventDefault(), h(r[a]);
		else if (t.key === "Enter") u.current.blur();
		else if (t.key === "Escape") {
			if (r.length) return p();
			n(e.value), c(null), d.current = !1, requestAnimationFrame(() => document.querySelector(".canvas svg")?.focus());
		}
	}, v = s ?? (t === e.value ? e.told ?? null : null);
	return /* @__PURE__ */ z("span", {
		class: "expression",
		children: [
			/* @__PURE__ */ z("input", {
				ref: u,
				"aria-label": e.label,
				value: t,
				disabled: e.disabled,
				placeholder: e.placeholder,
				spellcheck: !1,
				autocomplete: "off",
				role: "combobox",
				"aria-autocomplete": "list",
				"aria-expanded": r.length > 0,
				"aria-controls": l,
				"aria-activedescendant": a >= 0 ? `${l}-${a}` : void 0,
				"aria-invalid": !!v,
				"aria-describedby": v ? `${l}-wrong` : void 0,
				onFocus: () => d.current = !0,
				onInput: m,
				onBlur: g,
				onKeyDown: _
			}),
			r.length > 0 && /* @__PURE__ */ z("ul", {
				id: l,
				role: "listbox",
				"aria-label": "Names",
				children: r.map((e, t) => /* @__PURE__ */ z("li", {
					id: `${l}-${t}`,
					role: "option",
					"aria-selected": t === a,
					onMouseDown: (t) => {
						t.preventDefault(), h(e);
					},
					children: e
				}))
			}),
			v && /* @__PURE__ */ z("small", {
				class: "wrong",
				id: `${l}-wrong`,
				role: "status",
				children: [
					v.why,
					" ",
					v.try && /* @__PURE__ */ z("em", { children: v.try })
				]
			})
		]
	});
}
// src/machines.tsx
function cn(e) {
	let t = /^\s*(\w+)\s*->\s*(\w+)\s+when\s+(.+)$/s.exec(e);
	return t ? {
		source: t[1],
		target: t[2],
		guard: t[3]
	} : null;
}
function K({ store: e, state: t }) {
	let n = t.look, r = Object.entries(n.panels.machines);
	return /* @__PURE__ */ z("section", { children: [
		/* @__PURE__ */ z("h2", { children: "State machines" }),
		r.map(([n, r]) => /* @__PURE__ */ z(ln, {
			store: e,
			state: t,
			name: n,
			machine: r
		}, n)),
		n.view.editable && /* @__PURE__ */ z("button", {
			onClick: () => {
				let i = n.view.nodes.find((e) => t.nodes.has(e.name) && (e.kind === "0" || e.kind === "1")), a = nn([...r.map(([e]) => e), ...n.view.nodes.map((e) => e.name)], "S");
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
		/* @__PURE__ */ z("p", {
			class: "hint",
			children: [
				"In guards ",
				/* @__PURE__ */ z("code", { children: "pre(x)" }),
				" is the value before the instant (a priori ",
				/* @__PURE__ */ z("b", { children: "x⁻" }),
				"), ",
				/* @__PURE__ */ z("code", { children: "x" }),
				" the one that holds after it (a posteriori ",
				/* @__PURE__ */ z("b", { children: "x⁺" }),
				")."
			]
		})
	] });
}
function ln({ store: e, state: t, name: n, machine: r }) {
	let i = t.look, a = !i.view.editable, o = t.level ? `${t.level}.${n}` : n, s = t.cursor?.mode[o] ?? i.machines.find((e) => e.path === o)?.state, c = Object.keys(r.states ?? {}), l = r.rules ?? [], u = (t) => void e.edit({
		do: "set",
		path: ["machines", n],
		value: t
	}), d = (e, t) => u({
		...r,
		rules: t === null ? l.filter((t, n) => n !== e) : l.map((n, r) => r === e ? t : n)
	}), f = async (i, a) => {
		let o = {
			...r,
			rules: l.map((e, t) => t === i ? a : e)
		}, s = {
			do: "set",
			path: ["machines", n],
			value: o,
			level: t.level
		}, { problem: c } = await e.transport.ask("attempt", { edit: s });
		return c?.where.includes(n) ? c : null;
	}, p = i.view.nodes.filter((e) => e.kind !== "part" && e.kind !== "?").map((e) => e.name);
	return /* @__PURE__ */ z("div", {
		class: "machine",
		"data-machine": n,
		children: [
			/* @__PURE__ */ z("div", {
				class: "row",
				children: [/* @__PURE__ */ z(U, {
					label: `Name of machine ${n}`,
					value: n,
					disabled: a,
					onWrite: (t) => void e.edit({
						do: "rename",
						old: n,
						new: t.trim()
					})
				}), !a && /* @__PURE__ */ z("button", {
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
			/* @__PURE__ */ z(un, {
				machine: r,
				now: s,
				onState: (t) => e.setMode(o, t)
			}),
			c.map((t) => /* @__PURE__ */ z("div", {
				class: "row state",
				children: [
					/* @__PURE__ */ z("input", {
						type: "radio",
						name: `start-${n}`,
						"aria-label": `${n} starts in ${t}`,
						title: "start state",
						checked: r.start === t,
						disabled: a,
						onChange: () => u({
							...r,
							start: t
						})
					}),
					/* @__PURE__ */ z(U, {
						label: `State ${t} of ${n}`,
						value: t,
						disabled: a,
						onWrite: (i) => {
							let a = i.trim();
							if (!a) {
								let { [t]: e, ...n } = r.states;
								return u({
									...r,
									states: n,
									start: r.start === t ? Object.keys(n)[0] : r.start
								});
							}
							e.edit({
								do: "rename state",
								machine: n,
								old: t,
								new: a
							});
						}
					}),
					/* @__PURE__ */ z("span", {
						class: "on",
						children: "ON"
					}),
					/* @__PURE__ */ z(U, {
						label: `Junctions that state ${t} of ${n} switches on`,
						value: (r.states[t] ?? []).join(", "),
						disabled: a,
						list: p,
						placeholder: "none",
						onWrite: (e) => u({
							...r,
							states: {
								...r.states,
								[t]: e.split(/[\s,]+/).filter(Boolean)
							}
						})
					})
				]
			})),
			l.map((e, r) => {
				let i = cn(e), o = i && /\bpre\s*\(/.test(i.guard);
				return /* @__PURE__ */ z("div", {
					class: "row rule",
					children: [i ? /* @__PURE__ */ z(x, { children: [
						/* @__PURE__ */ z("select", {
							disabled: a,
							"aria-label": "From",
							value: i.source,
							onChange: (e) => d(r, `${e.currentTarget.value} -> ${i.target} when ${i.guard}`),
							children: c.map((e) => /* @__PURE__ */ z("option", { children: e }))
						}),
						"→",
						/* @__PURE__ */ z("select", {
							disabled: a,
							"aria-label": "To",
							value: i.target,
							onChange: (e) => d(r, `${i.source} -> ${e.currentTarget.value} when ${i.guard}`),
							children: c.map((e) => /* @__PURE__ */ z("option", { children: e }))
						}),
						/* @__PURE__ */ z(sn, {
							label: `Guard ${r + 1} of ${n}`,
							value: i.guard,
							disabled: a,
							words: W(t),
							check: (e) => f(r, `${i.source} -> ${i.target} when ${e}`),
							onWrite: (e) => d(r, `${i.source} -> ${i.target} when ${e}`)
						}),
						/* @__PURE__ */ z("span", {
							class: "reads " + (o ? "prior" : "after"),
							title: o ? "reads a priori values, x⁻" : "reads a posteriori values, x⁺",
							children: o ? "x⁻" : "x⁺"
						})
					] }) : /* @__PURE__ */ z(U, {
						label: `Rule ${r + 1} of ${n}`,
						value: e,
						disabled: a,
						onWrite: (e) => d(r, e)
					}), !a && /* @__PURE__ */ z("button", {
						class: "small",
						"aria-label": `Delete rule ${r + 1} of ${n}`,
						onClick: () => d(r, null),
						children: "✕"
					})]
				});
			}),
			!a && /* @__PURE__ */ z("div", {
				class: "row",
				children: [/* @__PURE__ */ z("button", {
					onClick: () => u({
						...r,
						states: {
							...r.states,
							[nn(c, "state")]: []
						}
					}),
					children: "Add state"
				}), /* @__PURE__ */ z("button", {
					disabled: c.length < 2,
					onClick: () => {
						let e = c.find((e) => !l.some((t) => cn(t)?.source === e)) ?? c[0], t = c.find((t) => t !== e);
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
function un({ machine: e, now: t, onState: n }) {
	let r = Object.keys(e.states ?? {}), i = (e) => 46 + 108 * r.indexOf(e), a = (e.rules ?? []).map(cn).filter((e) => !!e && r.includes(e.source) && r.includes(e.target)), o = /* @__PURE__ */ new Map(), s = 26 + 16 * Math.max(1, ...a.map((e) => Math.abs(r.indexOf(e.target) - r.indexOf(e.source))));
	return /* @__PURE__ */ z("div", {
		class: "diagram",
		children: /* @__PURE__ */ z("svg", {
			width: 46 + 108 * r.length,
			height: 2 * s + 10,
			viewBox: `0 ${-s} ${46 + 108 * r.length} ${2 * s + 10}`,
			role: "group",
			"aria-label": "States and rules",
			children: [
				/* @__PURE__ */ z("defs", { children: /* @__PURE__ */ z("marker", {
					id: "rulehead",
					viewBox: "0 0 8 8",
					refX: 7,
					refY: 4,
					markerWidth: 7,
					markerHeight: 7,
					orient: "auto",
					children: /* @__PURE__ */ z("path", {
						d: "M0,1L8,4L0,7z",
						class: "rulehead"
					})
				}) }),
				a.map((e) => {
					let [t, n] = [i(e.source), i(e.target)], r = `${e.source}>${e.target}`, a = o.get(r) ?? 0;
					if (o.set(r, a + 1), t === n) return /* @__PURE__ */ z("path", {
						class: "arc",
						d: `M${t - 8},-14 C${t - 26},-44 ${t + 26},-44 ${t + 8},-14`,
						"marker-end": "url(#rulehead)",
						children: /* @__PURE__ */ z("title", { children: e.guard })
					});
					let s = n > t ? -1 : 1, c = s * (22 + 14 * Math.abs(n - t) / 108 + 9 * a), l = e.guard.length > 26 ? e.guard.slice(0, 25) + "…" : e.guard;
					return /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("path", {
						class: "arc",
						d: `M${t},${14 * s} C${t},${c} ${n},${c} ${n},${14 * s}`,
						"marker-end": "url(#rulehead)",
						children: /* @__PURE__ */ z("title", { children: e.guard })
					}), /* @__PURE__ */ z("text", {
						class: "guard",
						x: (t + n) / 2,
						y: .78 * c + (s < 0 ? -3 : 10),
						"text-anchor": "middle",
						children: l
					})] });
				}),
				r.map((r) => /* @__PURE__ */ z("g", {
					class: "statebox" + (r === t ? " now" : "") + (r === e.start ? " start" : ""),
					role: "button",
					tabindex: 0,
					"aria-label": `Show state ${r}`,
					"aria-pressed": r === t,
					onClick: () => n(r),
					onKeyDown: (e) => (e.key === "Enter" || e.key === " ") && n(r),
					children: [
						/* @__PURE__ */ z("rect", {
							x: i(r) - 38,
							y: -14,
							width: 76,
							height: 28,
							rx: 8
						}),
						/* @__PURE__ */ z("text", {
							x: i(r),
							y: 4,
							"text-anchor": "middle",
							children: r.length > 11 ? r.slice(0, 10) + "…" : r
						}),
						r === e.start && /* @__PURE__ */ z("circle", {
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
// src/sweeps.tsx
var [dn, fn] = [720, 190], pn = 74, [mn, hn] = [8, 20], gn = [
	"var(--s0)",
	"var(--s1)",
	"var(--s2)",
	"var(--s3)",
	"var(--s4)",
	"var(--s5)",
	"var(--s6)",
	"var(--s7)"
];
function _n(e) {
	return `color-mix(in oklab, var(--c5) ${Math.round(100 * e)}%, var(--c1))`;
}
function vn({ store: e, state: t }) {
	let n = t.sweep, [r, i] = V(null), a = n.members.filter((e) => e), o = a.length ? (a.find((e) => e.curves)?.curves ?? []).map((e) => e.name) : [], s = a.filter((e) => e.error), c = a.find((e) => e.until !== void 0)?.until ?? 1;
	return /* @__PURE__ */ z("div", {
		class: "plots sweep",
		children: [
			/* @__PURE__ */ z("div", {
				class: "plotbar",
				children: [
					/* @__PURE__ */ z("b", { children: n.path }),
					" from ",
					n.values[0],
					" to ",
					n.values[n.values.length - 1],
					/* @__PURE__ */ z("span", {
						class: "scale",
						"aria-hidden": "true"
					}),
					/* @__PURE__ */ z("span", {
						role: "status",
						children: [n.done ? `${a.length} runs${a.length < n.values.length ? ", cancelled" : ""}` : `${a.length} of ${n.values.length}`, s.length > 0 && `, ${s.length} stopped: ${s[0].error.code}`]
					}),
					!n.done && /* @__PURE__ */ z("button", {
						onClick: e.cancel,
						children: "Cancel"
					}),
					/* @__PURE__ */ z("input", {
						type: "range",
						"aria-label": `Run of the sweep over ${n.path}`,
						min: 0,
						max: n.values.length - 1,
						step: 1,
						value: r ?? 0,
						onInput: (e) => i(Number(e.currentTarget.value))
					}),
					r !== null && /* @__PURE__ */ z(x, { children: [/* @__PURE__ */ z("output", { children: [
						n.path,
						" = ",
						n.values[r]
					] }), !n.path.includes(".") && /* @__PURE__ */ z("button", {
						onClick: () => {
							let t = n.values[r];
							n.path.split(".").length === 1 && e.edit({
								do: "set",
								path: ["parameters", n.path],
								value: t,
								level: ""
							}).then(() => e.start());
						},
						children: "Take this value"
					})] }),
					/* @__PURE__ */ z("button", {
						onClick: () => e.set({ sweep: null }),
						children: "Close"
					})
				]
			}),
			o.map((e, t) => /* @__PURE__ */ z(yn, {
				name: e,
				curves: n.members.map((e) => e?.curves?.[t]),
				end: c,
				chosen: r,
				choose: i
			}, e)),
			/* @__PURE__ */ z(bn, {
				sweep: n,
				end: c,
				chosen: r,
				choose: i
			})
		]
	});
}
function yn({ name: e, curves: t, end: n, chosen: r, choose: i }) {
	let a = t.filter((e) => !!e && !e.error), [o, s] = [Infinity, -Infinity];
	for (let e of a) for (let t of e.y) t !== null && ([o, s] = [Math.min(o, t), Math.max(s, t)]);
	if (!a.length || o > s) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: [
			e,
			": ",
			t.find((e) => e?.error)?.error?.why ?? "no values yet"
		]
	});
	let c = a[0].unit, l = s - o || Math.abs(s) || 1, u = (e) => pn + e / n * (dn - pn - 8), d = (e) => fn - hn - (e - o) / l * (fn - hn - mn), f = (e) => {
		let t = "", n = "M";
		return e.t.forEach((r, i) => {
			let a = e.y[i];
			a === null ? n = "M" : (t += `${n}${u(r).toFixed(1)},${d(a).toFixed(1)}`, n = "L");
		}), t;
	}, p = t.map((e, t) => t).filter((e) => e !== r);
	return r !== null && p.push(r), /* @__PURE__ */ z("svg", {
		class: "family",
		viewBox: `0 0 ${dn} ${fn}`,
		role: "img",
		"aria-label": `${e} of ${a.length} runs, between ${Se(o)} and ${Se(s)} ${c}`,
		children: [
			/* @__PURE__ */ z("rect", {
				class: "box",
				x: pn,
				y: mn,
				width: dn - pn - 8,
				height: fn - hn - mn
			}),
			o < 0 && s > 0 && /* @__PURE__ */ z("line", {
				class: "axis",
				x1: pn,
				x2: dn - 8,
				y1: d(0),
				y2: d(0)
			}),
			p.map((e) => {
				let n = t[e];
				return !n || n.error ? null : /* @__PURE__ */ z("path", {
					class: e === r ? "way chosen" : "way",
					d: f(n),
					style: `stroke: ${_n(e / Math.max(1, t.length - 1))}`,
					onClick: () => i(e),
					children: /* @__PURE__ */ z("title", { children: ["run ", e + 1] })
				}, e);
			}),
			/* @__PURE__ */ z("text", {
				x: 69,
				y: mn + 9,
				"text-anchor": "end",
				children: R(s, c)
			}),
			/* @__PURE__ */ z("text", {
				x: 69,
				y: fn - hn,
				"text-anchor": "end",
				children: R(o, c)
			}),
			/* @__PURE__ */ z("text", {
				class: "what",
				transform: `translate(12,${(fn - hn) / 2}) rotate(-90)`,
				"text-anchor": "middle",
				children: e
			}),
			/* @__PURE__ */ z("text", {
				x: pn,
				y: fn - 5,
				children: "0 s"
			}),
			/* @__PURE__ */ z("text", {
				x: dn - 8,
				y: fn - 5,
				"text-anchor": "end",
				children: R(n, "s")
			})
		]
	});
}
function bn({ sweep: e, end: t, chosen: n, choose: r }) {
	let i = [...e.members].reverse().find((e) => e?.named)?.named ?? [];
	if (i.length < 2) return null;
	let a = Math.max(...e.members.map((e) => e?.modes?.length ?? 0)), o = (dn - pn - 8) / e.values.length, s = (e) => {
		let t = [];
		return e.forEach((e, n) => {
			let r = t[t.length - 1];
			r && r[2] === e ? r[1] = n + 1 : t.push([
				n,
				n + 1,
				e
			]);
		}), t;
	};
	return /* @__PURE__ */ z("figure", {
		class: "modemap",
		children: [/* @__PURE__ */ z("svg", {
			viewBox: `0 0 ${dn} 184`,
			role: "img",
			"aria-label": `Modes over ${e.path} and time: ${i.join("; ")}`,
			children: [
				e.members.map((t, c) => t?.modes ? /* @__PURE__ */ z("g", {
					class: c === n ? "chosen" : "",
					onClick: () => r(c),
					children: s(t.modes).map(([t, n, r]) => /* @__PURE__ */ z("rect", {
						x: pn + c * o,
						width: o + .4,
						y: mn + 150 * (1 - n / a),
						height: 150 * (n - t) / a + .4,
						fill: gn[r % gn.length],
						children: /* @__PURE__ */ z("title", { children: `${e.values[c]}: ${i[r]}` })
					}))
				}) : null),
				/* @__PURE__ */ z("text", {
					x: 69,
					y: mn + 9,
					"text-anchor": "end",
					children: R(t, "s")
				}),
				/* @__PURE__ */ z("text", {
					x: 69,
					y: mn + 150,
					"text-anchor": "end",
					children: "0 s"
				}),
				/* @__PURE__ */ z("text", {
					x: pn,
					y: mn + 150 + 14,
					children: e.values[0]
				}),
				/* @__PURE__ */ z("text", {
					x: dn - 8,
					y: mn + 150 + 14,
					"text-anchor": "end",
					children: e.values[e.values.length - 1]
				}),
				/* @__PURE__ */ z("text", {
					class: "what",
					x: (pn + dn) / 2,
					y: mn + 150 + 18,
					"text-anchor": "middle",
					children: e.path
				})
			]
		}), /* @__PURE__ */ z("figcaption", { children: [i.slice(0, 16).map((e, t) => /* @__PURE__ */ z("span", { children: [
			/* @__PURE__ */ z("i", { style: `background: ${gn[t % gn.length]}` }),
			" ",
			e
		] })), i.length > 16 && ` and ${i.length - 16} more`] })]
	});
}
function xn({ store: e, path: t, low: n, high: r, onDone: i }) {
	let [a, o] = V(n), [s, c] = V(r), [l, u] = V("15"), [d, f] = V(!1), p = (n) => {
		n.preventDefault(), e.sweep({
			path: t,
			from: a,
			to: s,
			count: l,
			log: d
		}).then((e) => e && i());
	}, m = (e, n, r) => /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: e }), /* @__PURE__ */ z("input", {
		"aria-label": `Sweep ${t} ${e}`,
		value: n,
		onInput: (e) => r(e.currentTarget.value),
		onKeyDown: (e) => e.stopPropagation()
	})] });
	return /* @__PURE__ */ z("form", {
		class: "sweepfields",
		onSubmit: p,
		children: [
			m("from", a, o),
			m("to", s, c),
			m("runs", l, u),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("input", {
				type: "checkbox",
				checked: d,
				onChange: (e) => f(e.currentTarget.checked)
			}), " by ratios"] }),
			/* @__PURE__ */ z("button", {
				type: "submit",
				children: "Sweep"
			})
		]
	});
}
// src/panels.tsx
function Sn({ store: e, state: t }) {
	let n = t.look, r = !n.view.editable, i = n.panels.experiment, a = (t, n) => e.edit({
		do: "set",
		path: t,
		value: n
	}), o = (i, o, s) => {
		let c = Object.entries(n.panels[i]);
		return /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("h2", { children: o }),
			c.map(([n, r]) => /* @__PURE__ */ z(wn, {
				store: e,
				state: t,
				section: i,
				name: n,
				value: r
			}, n)),
			!r && /* @__PURE__ */ z("button", {
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
					a([i, nn(t, e)], s);
				},
				children: "Add"
			})
		] });
	};
	return /* @__PURE__ */ z("section", { children: [
		o("parameters", "Parameters", 1),
		o("signals", "Signals", "time"),
		o("inputs", "Inputs", { constant: 1 }),
		!t.level && /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("h2", { children: "Run" }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "until" }), /* @__PURE__ */ z(U, {
				label: "Until",
				value: rn(i.until),
				placeholder: "1 s",
				onWrite: (e) => void a(["experiment", "until"], Gt(e))
			})] }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "solver" }), /* @__PURE__ */ z("select", {
				value: rn(i.solver),
				onChange: (e) => void a(["experiment", "solver"], e.currentTarget.value || null),
				children: [/* @__PURE__ */ z("option", {
					value: "",
					children: "auto"
				}), t.stock?.solvers.filter((e) => e.name !== "auto").map((e) => /* @__PURE__ */ z("option", {
					value: e.name,
					title: e.about,
					children: e.name
				}))]
			})] }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "rtol" }), /* @__PURE__ */ z(U, {
				label: "Relative tolerance",
				value: rn(i.rtol),
				placeholder: "1e-8",
				onWrite: (e) => void a(["experiment", "rtol"], Gt(e))
			})] })
		] })
	] });
}
var Cn = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(\s*\S.*)?$/i;
function wn({ store: e, state: t, section: n, name: r, value: i }) {
	let a = !t.look.view.editable, o = typeof i != "object", s = n === "parameters" ? Cn.exec(rn(i)) : null, [c] = V(() => s && Number(s[1]) || 1), [l, u] = V(!1), d = t.level ? `${t.level}.${r}` : r, f = (e) => `${+((Number(s?.[1]) || 1) * e).toPrecision(6)}${s?.[2] ?? ""}`;
	return /* @__PURE__ */ z("div", {
		class: "entry",
		"data-entry": r,
		children: [
			/* @__PURE__ */ z("label", { children: [
				/* @__PURE__ */ z(U, {
					label: `Name ${r}`,
					value: r,
					disabled: a,
					onWrite: (t) => void e.edit({
						do: "rename",
						old: r,
						new: t.trim()
					})
				}),
				o ? /* @__PURE__ */ z(U, {
					label: r,
					value: rn(i),
					disabled: a,
					list: n === "signals" ? W(t) : void 0,
					onWrite: (t) => void e.edit({
						do: "set",
						path: [n, r],
						value: Gt(t)
					})
				}) : /* @__PURE__ */ z(Tn, {
					store: e,
					path: [n, r],
					value: i,
					off: a
				}),
				s && /* @__PURE__ */ z("button", {
					class: "small",
					"aria-label": `Sweep ${r}`,
					title: "Run over a range",
					"aria-pressed": l,
					onClick: () => u(!l),
					children: "⋯"
				}),
				!a && /* @__PURE__ */ z("button", {
					class: "small",
					"aria-label": `Delete ${r}`,
					onClick: () => void e.edit({
						do: "set",
						path: [n, r],
						value: null
					}),
					children: "✕"
				})
			] }),
			l && s && /* @__PURE__ */ z(xn, {
				store: e,
				path: d,
				low: f(.5),
				high: f(2),
				onDone: () => u(!1)
			}),
			s && !a && /* @__PURE__ */ z("input", {
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
			})
		]
	});
}
function Tn({ store: e, path: t, value: n, off: r }) {
	return /* @__PURE__ */ z("span", {
		class: "structured",
		children: Object.entries(n).map(([n, i]) => typeof i == "object" && i && !Array.isArray(i) ? /* @__PURE__ */ z(Tn, {
			store: e,
			path: [...t, n],
			value: i,
			off: r
		}) : /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: n }), /* @__PURE__ */ z(U, {
			label: `${t.join(" ")} ${n}`,
			value: rn(i),
			disabled: r,
			onWrite: (r) => {
				let i = Gt(r);
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
function En({ store: e, state: t }) {
	let n = t.look.problems;
	return /* @__PURE__ */ z("section", { children: [
		/* @__PURE__ */ z("h2", { children: "Problems" }),
		!n.length && /* @__PURE__ */ z("p", { children: "None." }),
		/* @__PURE__ */ z("ul", {
			class: "problems",
			children: n.map((t) => /* @__PURE__ */ z("li", {
				class: t.grave,
				children: /* @__PURE__ */ z("button", {
					onClick: () => e.select(t.select),
					children: [
						/* @__PURE__ */ z("b", { children: t.code }),
						" ",
						t.where && /* @__PURE__ */ z("i", { children: t.where }),
						/* @__PURE__ */ z("span", { children: t.why }),
						t.try && /* @__PURE__ */ z("em", { children: ["Try: ", t.try] })
					]
				})
			}))
		})
	] });
}
function Dn({ store: e, state: t }) {
	let { view: n, strokes: r } = t.look;
	return /* @__PURE__ */ z("section", {
		class: "tables",
		children: [
			/* @__PURE__ */ z("h2", { children: "Elements" }),
			/* @__PURE__ */ z("table", { children: [/* @__PURE__ */ z("thead", { children: /* @__PURE__ */ z("tr", { children: [
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "name"
				}),
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "kind"
				}),
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "value"
				}),
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "state"
				})
			] }) }), /* @__PURE__ */ z("tbody", { children: n.nodes.map((n) => {
				let i = r.nodes[n.name];
				return /* @__PURE__ */ z("tr", {
					class: t.nodes.has(n.name) ? "chosen" : "",
					children: [
						/* @__PURE__ */ z("td", { children: /* @__PURE__ */ z("button", {
							class: "link",
							onClick: () => e.set({
								nodes: /* @__PURE__ */ new Set([n.name]),
								bonds: /* @__PURE__ */ new Set()
							}),
							children: n.name
						}) }),
						/* @__PURE__ */ z("td", { children: n.kind === "part" ? String(n.entry.submodel) : n.kind }),
						/* @__PURE__ */ z("td", { children: i?.says ?? n.says }),
						/* @__PURE__ */ z("td", { children: [
							i?.off ? "OFF" : i?.controlled ? "ON" : "",
							i?.derivative ? "derivative" : "",
							n.law ?? "",
							n.machine ?? ""
						].filter(Boolean).join(", ") })
					]
				});
			}) })] }),
			/* @__PURE__ */ z("h2", { children: "Bonds" }),
			/* @__PURE__ */ z("table", { children: [/* @__PURE__ */ z("thead", { children: /* @__PURE__ */ z("tr", { children: [
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "bond"
				}),
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "stroke at"
				}),
				/* @__PURE__ */ z("th", {
					scope: "col",
					children: "other modes"
				})
			] }) }), /* @__PURE__ */ z("tbody", { children: n.bonds.map((n) => {
				let i = r.bonds[n.key] ?? r.bonds[`${n.ends[0]} -> ${n.ends[1]}`];
				return /* @__PURE__ */ z("tr", {
					class: t.bonds.has(n.key) ? "chosen" : "",
					children: [
						/* @__PURE__ */ z("td", { children: /* @__PURE__ */ z("button", {
							class: "link",
							onClick: () => e.set({
								bonds: /* @__PURE__ */ new Set([n.key]),
								nodes: /* @__PURE__ */ new Set()
							}),
							children: n.text
						}) }),
						/* @__PURE__ */ z("td", { children: i ? i.strokes.map((e) => n.ends[e]).join(", ") + (i.conflict ? " (conflict)" : "") + (i.off ? " (OFF)" : "") : "—" }),
						/* @__PURE__ */ z("td", { children: i?.dashed?.map((e) => n.ends[e]).join(", ") ?? "" })
					]
				});
			}) })] })
		]
	});
}
function On({ store: e, state: t }) {
	let [n, r] = V(null), [i, a] = V(null), o = t.look.revision;
	H(() => {
		let t = !1;
		return e.transport.ask("text").then((e) => !t && r(e)).catch(() => {}), () => {
			t = !0;
		};
	}, [o]);
	let s = () => {
		i !== null && e.ask("replace", { text: i }).then((e) => e && a(null));
	};
	return /* @__PURE__ */ z("section", {
		class: "textpanel",
		children: [
			/* @__PURE__ */ z("h2", { children: [
				t.look.file,
				" ",
				i !== null && /* @__PURE__ */ z("small", { children: "not applied" })
			] }),
			/* @__PURE__ */ z("textarea", {
				"aria-label": "Text of the model file",
				spellcheck: !1,
				value: i ?? n?.text ?? "",
				onInput: (e) => a(e.currentTarget.value),
				onKeyDown: (e) => {
					e.key === "Enter" && (e.ctrlKey || e.metaKey) && s(), e.stopPropagation();
				}
			}),
			/* @__PURE__ */ z("div", {
				class: "row",
				children: [/* @__PURE__ */ z("button", {
					disabled: i === null,
					onClick: s,
					children: "Apply (Ctrl+Enter)"
				}), /* @__PURE__ */ z("button", {
					disabled: i === null,
					onClick: () => a(null),
					children: "Discard"
				})]
			})
		]
	});
}
// src/palette.tsx
function kn(e) {
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
function An({ store: e, state: t }) {
	let [n, r] = V(""), { kinds: i, parts: a } = kn(t), o = t.look?.view.domain ?? "", s = n.toLowerCase().split(/\s+/).filter(Boolean), c = (e) => s.every((t) => `${e.key} ${e.about}`.toLowerCase().includes(t)), l = [...a].sort(([e], [t]) => Number(t === o) - Number(e === o)), u = (e) => (t) => t.dataTransfer.setData("application/x-hybond", JSON.stringify({
		element: e.element,
		stem: e.stem
	})), d = (t) => {
		e.add(t.element, t.stem), e.set({ panel: "" });
	}, f = !t.look?.view.editable;
	return /* @__PURE__ */ z("aside", {
		class: "palette" + (t.panel === "palette" ? " open" : ""),
		"aria-label": "Palette",
		children: [
			/* @__PURE__ */ z("div", {
				class: "kinds",
				children: i.map((e) => /* @__PURE__ */ z("button", {
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
			/* @__PURE__ */ z("input", {
				type: "search",
				placeholder: "Parts …",
				"aria-label": "Search parts",
				value: n,
				onInput: (e) => r(e.currentTarget.value)
			}),
			/* @__PURE__ */ z("div", {
				class: "shelves",
				tabindex: 0,
				role: "region",
				"aria-label": "Ready parts",
				children: l.map(([e, t]) => {
					let n = t.filter(c);
					return n.length ? /* @__PURE__ */ z("details", {
						open: s.length > 0 || e === o,
						children: [/* @__PURE__ */ z("summary", { children: [
							e,
							" ",
							/* @__PURE__ */ z("small", { children: n.length })
						] }), n.map((e) => /* @__PURE__ */ z("button", {
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
var jn = /^[A-Za-z_]\w*$/, Mn = 8, Nn = 5;
function Pn(e, t) {
	let n = e.letters.replaceAll("_", " ").toLowerCase(), r = t.replaceAll("_", " ");
	return n === r || e.key === t ? 0 : n.startsWith(r) ? 1 : ` ${n}`.includes(` ${r}`) ? 2 : `${e.key} ${n}`.includes(r) ? 3 : e.about.toLowerCase().includes(r) ? 4 : Nn;
}
function Fn(e) {
	let t = (e.look?.view.nodes ?? []).filter((e) => String(e.entry.submodel ?? "").includes(".")), n = t.find((t) => e.nodes.has(t.name)) ?? t[t.length - 1];
	return n ? String(n.entry.submodel).split(".")[0] : e.look?.view.domain ?? "";
}
function In(e, t) {
	let { kinds: n, parts: r } = kn(e), i = [...n, ...[...r.values()].flat()], [a, ...o] = t.trim().split(/\s+/), s = n.find((e) => e.key === a), c = !s && o.length === 1 && jn.test(o[0]) && i.some((e) => e.letters === a), l = (c ? a : t.trim()).toLowerCase(), u = Fn(e);
	return {
		exact: s,
		called: c,
		rest: o,
		found: t.includes("->") ? [] : s ? [s, ...i.filter((e) => e !== s && e.key.includes(a))] : i.map((e) => ({
			o: e,
			rank: 2 * Pn(e, l) - Number(e.key.startsWith(`${u}.`))
		})).filter(({ rank: e }) => e < 9).sort((e, t) => e.rank - t.rank).map(({ o: e }) => e)
	};
}
function Ln({ store: e, state: t }) {
	return /* @__PURE__ */ z(It, {
		title: "Add",
		ask: "What to add",
		placeholder: "R load 10 ohm · diode · a -> b",
		most: Mn,
		fitting: (e) => In(t, e).found,
		say: (e) => /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("b", { children: e.letters }),
			" ",
			e.about,
			e.key.includes(".") && /* @__PURE__ */ z("small", { children: [" ", e.key.split(".")[0]] })
		] }),
		take: async (n, r) => {
			if (r.includes("->")) return await e.edit({
				do: "write bond",
				text: r.trim()
			}), !0;
			if (!n) return !1;
			let { exact: i, called: a, rest: o } = In(t, r), s = n.element, c = "";
			if (n.key === i?.key) {
				o.length && jn.test(o[0]) && (c = o.shift());
				let e = o.join(" ");
				e && !("junction" in s) && (s = { [n.key]: e });
			} else a && (c = o[0]);
			return await e.add(s, c || n.stem), !0;
		},
		close: () => e.set({ adding: !1 })
	});
}
// src/axes.ts
function Rn(e) {
	return /^([^:,()]+\.\.[^:,()]+?)(:11)?$/.exec(e.trim())?.[1] ?? null;
}
function zn(e, t, n, r = 5) {
	if (!(t - e > 1e-9 * Math.max(Math.abs(e), Math.abs(t)))) {
		let r = Math.abs(e) * .1 || 1;
		[e, t] = n ? [e * .9, e * 1.1] : [e - r, t + r];
	}
	if (!n) return {
		low: e,
		high: t,
		log: n,
		part: (n) => (n - e) / (t - e),
		value: (n) => e + n * (t - e),
		ticks: Hn(e, t, r)
	};
	let [i, a] = [Math.log(e), Math.log(t)];
	return {
		low: e,
		high: t,
		log: n,
		part: (e) => (Math.log(e) - i) / (a - i),
		value: (e) => Math.exp(i + e * (a - i)),
		ticks: Un(e, t, r)
	};
}
function Bn(e, t, n) {
	if (e.edges) return zn(e.edges[0], e.edges[e.edges.length - 1], e.log, n);
	let [r, i] = Vn(t.filter((e) => e !== null));
	if (e.log) return zn(r / (i / r) ** .04, i * (i / r) ** .04, !0, n);
	let a = .05 * (i - r);
	return zn(r - a, i + a, !1, n);
}
function Vn(e) {
	let [t, n] = [Infinity, -Infinity];
	for (let r of e) r < t && (t = r), r > n && (n = r);
	return t <= n ? [t, n] : [0, 1];
}
function Hn(e, t, n) {
	let r = (t - e) / n, i = 10 ** Math.floor(Math.log10(r)), a = [
		1,
		2,
		5,
		10
	].map((e) => e * i).find((e) => e >= r * .999) ?? r, o = [];
	for (let n = Math.ceil(e / a - 1e-9); n * a <= t * (1 + 1e-12) + 1e-9 * a; n++) o.push(+(n * a).toPrecision(12));
	return o;
}
function Un(e, t, n) {
	let r = [];
	for (let i of [
		[1],
		[1, 3],
		[
			1,
			2,
			5
		]
	]) {
		r.length = 0;
		for (let n = Math.floor(Math.log10(e)); n <= Math.ceil(Math.log10(t)); n++) for (let a of i) a * 10 ** n >= e * .999 && a * 10 ** n <= t * 1.001 && r.push(+(a * 10 ** n).toPrecision(6));
		if (r.length >= n - 2) break;
	}
	return r.length > 1 ? r : [e, t];
}
function Wn(e, t) {
	return t ? `${e} [${I(t)}]` : e;
}
function q(e) {
	return e === null ? "none" : Se(e, 5).replace(/\.?0+e/, "e");
}
var Gn = [
	"440154",
	"482878",
	"3e4989",
	"31688e",
	"26828e",
	"1f9e89",
	"35b779",
	"6ece58",
	"b5de2b",
	"fde725"
];
function Kn(e) {
	let t = Math.min(Math.max(e, 0), 1) * (Gn.length - 1), n = Math.min(Math.floor(t), Gn.length - 2);
	return `rgb(${[
		0,
		2,
		4
	].map((e) => {
		let [r, i] = [Gn[n], Gn[n + 1]].map((t) => parseInt(t.slice(e, e + 2), 16));
		return Math.round(r + (t - n) * (i - r));
	}).join(",")})`;
}
var qn = Gn.map((e) => `#${e}`).join(", "), Jn = 120, Yn = "HB-W103", Xn = [
	"grid",
	"together",
	"ends"
], Zn = ["grid", "together"];
function Qn({ store: e, state: t }) {
	let [n, r] = V(null), [i, a] = V(null), [o, s] = V(null), c = t.look.revision, l = t.asking;
	if (H(() => {
		let t = !1;
		return e.transport.ask("plan words").then((n) => {
			t || (r(n), a(null), e.state.asking || e.set({ asking: tr(n) }));
		}).catch((e) => !t && a(e.problem ?? null)), () => {
			t = !0;
		};
	}, [c]), H(() => {
		if (!l) return;
		let t = !1, n = setTimeout(() => {
			e.transport.ask("plan look", l).then((e) => !t && s(e)).catch((e) => !t && a(e.problem ?? null));
		}, Jn);
		return () => {
			t = !0, clearTimeout(n);
		};
	}, [l, c]), i) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: [
			"There is nothing to sweep yet: ",
			i.code,
			" ",
			i.why
		]
	});
	if (!n || !l) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "…"
	});
	let u = (t) => e.set({ asking: {
		...e.state.asking,
		...t
	} }), d = (t, n) => (r) => e.transport.ask("plan look", n(r)).then((e) => e.wrong[t] ?? null), f = o?.wrong ?? {}, p = t.plan?.state === "running", m = (e, t) => l.factors.map((n, r) => r === e ? {
		...n,
		...t
	} : n), h = (e, t) => {
		let r = t.trim(), i = n.values[r], a = l.factors[e], o = i && (!a.values || a.values === nr(n.values[a.path] ?? "", l.way));
		return m(e, {
			path: r,
			...o ? { values: nr(i, l.way) } : {}
		});
	}, g = (e) => u({
		way: e,
		count: l.count || "128",
		factors: l.factors.map((t) => ({
			...t,
			values: nr(t.values, e)
		}))
	}), _ = () => {
		let e = n.paths.find((e) => e in n.values && !l.factors.some((t) => t.path === e)) ?? "";
		u({ factors: [...l.factors, {
			path: e,
			values: nr(n.values[e] ?? "", l.way)
		}] });
	}, v = o?.members ?? 0;
	return /* @__PURE__ */ z("section", {
		class: "plan",
		children: [
			/* @__PURE__ */ z("h2", { children: "What varies" }),
			l.factors.map((e, t) => /* @__PURE__ */ z("div", {
				class: "factor",
				"data-factor": t,
				children: [
					/* @__PURE__ */ z(sn, {
						label: `Factor ${t + 1}`,
						value: e.path,
						words: n.paths,
						placeholder: "mu, pad.C, ball.f",
						onWrite: (e) => u({ factors: h(t, e) }),
						check: d(`path.${t}`, (e) => ({
							...l,
							factors: h(t, e)
						})),
						told: f[`path.${t}`]
					}),
					/* @__PURE__ */ z(sn, {
						label: `Values of factor ${t + 1}`,
						value: e.values,
						words: [
							"lin(",
							"log(",
							"uniform(",
							"loguniform(",
							"normal(",
							"lognormal(",
							"truncnormal(",
							"triangular("
						],
						placeholder: "0.2:0.3:0.005",
						onWrite: (e) => u({ factors: m(t, { values: e.trim() }) }),
						check: d(`values.${t}`, (e) => ({
							...l,
							factors: m(t, { values: e })
						})),
						told: f[`values.${t}`]
					}),
					/* @__PURE__ */ z("button", {
						class: "small",
						"aria-label": `Leave out factor ${t + 1}`,
						disabled: l.factors.length < 2,
						onClick: () => u({ factors: l.factors.filter((e, n) => n !== t) }),
						children: "✕"
					})
				]
			}, t)),
			/* @__PURE__ */ z("div", {
				class: "row",
				children: /* @__PURE__ */ z("button", {
					onClick: _,
					children: "Add a factor"
				})
			}),
			/* @__PURE__ */ z("details", { children: [/* @__PURE__ */ z("summary", { children: "How values are written" }), /* @__PURE__ */ z("dl", { children: [
				/* @__PURE__ */ z("dt", { children: "0.2:0.3:0.005" }),
				/* @__PURE__ */ z("dd", { children: "from, to, step" }),
				/* @__PURE__ */ z("dt", { children: "1..2 kg:11, log(1e-4, 1e-2, 50)" }),
				/* @__PURE__ */ z("dd", { children: "so many, evenly or by ratios" }),
				/* @__PURE__ */ z("dt", { children: "1 kg, 1.5 kg" }),
				/* @__PURE__ */ z("dd", { children: "these" }),
				/* @__PURE__ */ z("dt", { children: "1..2 kg, log(1e-4, 1e-2), normal(1 kg, 50 g)" }),
				/* @__PURE__ */ z("dd", { children: "distributions, for samples" })
			] })] }),
			/* @__PURE__ */ z("h2", { children: "How members are drawn" }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "way" }), /* @__PURE__ */ z("select", {
				"aria-label": "Way",
				value: l.way,
				onChange: (e) => g(e.currentTarget.value),
				children: Object.keys(n.ways).map((e) => /* @__PURE__ */ z("option", {
					value: e,
					children: $n[e] ?? e
				}))
			})] }),
			/* @__PURE__ */ z("p", {
				class: "hint",
				children: n.ways[l.way]
			}),
			!Xn.includes(l.way) && /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "number" }), /* @__PURE__ */ z(U, {
				label: "Number",
				value: l.count,
				onWrite: (e) => u({ count: e.trim() })
			})] }),
			!Zn.includes(l.way) && l.way !== "ends" && /* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "seed" }), /* @__PURE__ */ z(U, {
				label: "Seed",
				value: l.seed,
				onWrite: (e) => u({ seed: e.trim() || "0" })
			})] }),
			/* @__PURE__ */ z(er, { problem: f.seed ?? f.way }),
			/* @__PURE__ */ z("h2", { children: "What is collected" }),
			/* @__PURE__ */ z(sn, {
				label: "Collect",
				value: l.collect,
				words: n.words,
				placeholder: "final(x), max(x), count(events), sequence",
				onWrite: (e) => u({ collect: e.trim() }),
				check: d("collect", (e) => ({
					...l,
					collect: e
				})),
				told: f.collect
			}),
			/* @__PURE__ */ z("details", { children: [/* @__PURE__ */ z("summary", { children: "What can be collected" }), /* @__PURE__ */ z("ul", { children: Object.values(n.collectors).map((e) => {
				let [, t, n] = /^(\w+(?:\([^)]*\))?)[:,] (.*)$/.exec(e) ?? [
					"",
					e,
					""
				];
				return /* @__PURE__ */ z("li", { children: [
					/* @__PURE__ */ z("code", { children: t }),
					" ",
					n
				] });
			}) })] }),
			/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("span", { children: "until" }), /* @__PURE__ */ z(U, {
				label: "Until of the sweep",
				value: l.until,
				placeholder: String(t.look.panels.experiment.until ?? "1 s"),
				onWrite: (e) => u({ until: e.trim() })
			})] }),
			/* @__PURE__ */ z(er, { problem: f.until }),
			/* @__PURE__ */ z("div", {
				class: "row begin",
				children: [p ? /* @__PURE__ */ z("button", {
					class: "run",
					onClick: () => void e.transport.ask("plan cancel").catch(() => {}),
					children: "Cancel"
				}) : /* @__PURE__ */ z("button", {
					class: "run",
					disabled: !v || Object.keys(f).length > 0,
					onClick: () => void e.sweepPlan(e.state.asking),
					children: ["▶ Run ", v > 0 ? `${v} members` : "the sweep"]
				}), t.plan && !t.planShown && /* @__PURE__ */ z("button", {
					onClick: () => e.set({
						planShown: !0,
						bottom: !0,
						panel: ""
					}),
					children: "Show the last"
				})]
			}),
			o && Object.values(f).every((e) => e.code === Yn) && /* @__PURE__ */ z(x, { children: [/* @__PURE__ */ z("h2", { children: "The same in a terminal" }), /* @__PURE__ */ z("div", {
				class: "command",
				children: [/* @__PURE__ */ z("code", {
					tabindex: 0,
					children: o.command
				}), /* @__PURE__ */ z("button", {
					onClick: () => void navigator.clipboard?.writeText(o.command).catch((t) => e.refused(t)),
					children: "Copy"
				})]
			})] })
		]
	});
}
var $n = {
	grid: "all combinations",
	together: "side by side",
	random: "at random",
	lhs: "Latin hypercube",
	sobol: "Sobol' sequence",
	saltelli: "for Sobol indices",
	ends: "for a tornado"
};
function er({ problem: e }) {
	return e ? /* @__PURE__ */ z("small", {
		class: "wrong",
		role: "status",
		children: [
			e.why,
			" ",
			e.try && /* @__PURE__ */ z("em", { children: e.try })
		]
	}) : null;
}
function tr(e) {
	let t = e.paths.find((t) => t in e.values) ?? e.paths[0] ?? "";
	return {
		factors: [{
			path: t,
			values: e.values[t] ?? ""
		}],
		way: "grid",
		count: "128",
		seed: "0",
		until: "",
		collect: e.collect
	};
}
function nr(e, t) {
	let n = Rn(e);
	return n ? Zn.includes(t) ? `${n}:11` : n : e;
}
// src/bands.tsx
var [rr, ir, ar, or] = [
	66,
	14,
	10,
	38
];
function sr({ found: e, wide: t, high: n, chosen: r, choose: i, open: a }) {
	let { t: o, bands: s, curves: c } = e, l = [...s, ...c].flat().filter((e) => e !== null);
	if (!l.length) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "No run has come so far that it has values."
	});
	let u = t > 620, d = Math.max(t - (u ? 230 : 0), 160), [f, p] = [d - rr - ir, n - ar - or], [m, h] = Vn(l), g = .05 * (h - m), _ = zn(o[0], o[o.length - 1], !1, Math.max(2, Math.round(f / 90))), v = zn(m - g, h + g, !1, Math.max(2, Math.round(p / 45))), y = (e) => rr + _.part(e) * f, b = (e) => ar + (1 - v.part(e)) * p, x = (e) => {
		let [t, n] = ["", "M"];
		return e.forEach((e, r) => {
			e === null ? n = "M" : [t, n] = [`${t}${n}${y(o[r]).toFixed(1)},${b(e).toFixed(1)}`, "L"];
		}), t;
	}, S = (e, t) => {
		let n = "";
		for (let r = 0; r < o.length; r++) {
			if (e[r] === null || t[r] === null) continue;
			let i = r;
			for (; i + 1 < o.length && e[i + 1] !== null && t[i + 1] !== null;) i++;
			let a = (e, t) => `${y(o[t]).toFixed(1)},${b(e[t]).toFixed(1)}`, s = Array.from({ length: i - r + 1 }, (e, t) => r + t);
			n += `M${s.map((e) => a(t, e)).join("L")}L${s.reverse().map((t) => a(e, t)).join("L")}Z`, r = i;
		}
		return n;
	}, [C, w, T, E, D] = s, O = r === null ? -1 : e.members.indexOf(r);
	return /* @__PURE__ */ z("figure", {
		class: "outcomes" + (u ? " beside" : ""),
		"data-view": "family",
		children: [/* @__PURE__ */ z("div", {
			class: "area",
			style: `width: ${d}px; height: ${n}px`,
			tabindex: 0,
			role: "group",
			"aria-label": `${e.signal} of many runs over time. Arrows choose a run, Enter opens it.`,
			onKeyDown: (t) => {
				if (t.key === "Enter" && r !== null) return a(r);
				let n = {
					ArrowRight: 1,
					ArrowUp: 1,
					ArrowLeft: -1,
					ArrowDown: -1
				}[t.key];
				if (!n) return;
				t.preventDefault();
				let o = O < 0 ? 0 : O + n;
				e.members[o] !== void 0 && i(e.members[o]);
			},
			children: /* @__PURE__ */ z("svg", {
				width: d,
				height: n,
				role: "img",
				"aria-label": `${e.signal}: from ${q(m)} to ${q(h)} ${e.unit}; the median ends at ${q(T[T.length - 1])}`,
				children: [
					/* @__PURE__ */ z("rect", {
						class: "box",
						x: rr,
						y: ar,
						width: f,
						height: p
					}),
					/* @__PURE__ */ z("path", {
						class: "band",
						d: S(C, D)
					}),
					/* @__PURE__ */ z("path", {
						class: "band inner",
						d: S(w, E)
					}),
					c.map((t, n) => n === O ? null : /* @__PURE__ */ z("path", {
						class: "one",
						d: x(t),
						onClick: () => (i(e.members[n]), a(e.members[n])),
						children: /* @__PURE__ */ z("title", { children: ["run ", e.members[n]] })
					})),
					/* @__PURE__ */ z("path", {
						class: "median",
						d: x(T)
					}),
					O >= 0 && /* @__PURE__ */ z("path", {
						class: "one chosen",
						d: x(c[O]),
						onClick: () => a(r)
					}),
					_.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
						class: "tick",
						x1: y(e),
						x2: y(e),
						y1: ar + p,
						y2: ar + p + 4
					}), /* @__PURE__ */ z("text", {
						x: y(e),
						y: ar + p + 15,
						"text-anchor": "middle",
						children: R(e, "s")
					})] })),
					v.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
						class: "tick",
						x1: rr - 4,
						x2: rr,
						y1: b(e),
						y2: b(e)
					}), /* @__PURE__ */ z("text", {
						x: rr - 7,
						y: b(e) + 3.5,
						"text-anchor": "end",
						children: q(e)
					})] })),
					/* @__PURE__ */ z("text", {
						class: "what",
						x: rr + f / 2,
						y: n - 6,
						"text-anchor": "middle",
						children: "time"
					}),
					/* @__PURE__ */ z("text", {
						class: "what",
						transform: `translate(12,${ar + p / 2}) rotate(-90)`,
						"text-anchor": "middle",
						children: Wn(e.signal, e.unit)
					})
				]
			})
		}), /* @__PURE__ */ z("figcaption", { children: [
			/* @__PURE__ */ z("b", { children: Wn(e.signal, e.unit) }),
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { class: "line median" }), " median"]
			}),
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { class: "fill inner" }), " 25 to 75 %"]
			}),
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { class: "fill" }), " 5 to 95 %"]
			}),
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [
					/* @__PURE__ */ z("i", { class: "line one" }),
					" ",
					e.members.length,
					" of ",
					e.kept,
					" runs"
				]
			}),
			e.every > 1 && /* @__PURE__ */ z("small", { children: [
				"every ",
				e.every,
				". of the times is drawn"
			] }),
			/* @__PURE__ */ z("output", { children: O >= 0 ? `run ${r}` : "" })
		] })]
	});
}
// src/bars.tsx
var [cr, lr, ur] = [
	22,
	40,
	34
];
function dr(e, t) {
	return Math.min(24 + 7 * Math.max(...e.map((e) => e.length)), t * .35);
}
function fr({ found: e, wide: t, open: n }) {
	let r = e.middle;
	if (r === null) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "The run in the middle has no value."
	});
	let i = Math.min(t, 820), a = dr(e.rows.map((e) => Wn(e.path, e.unit)), i), [o, s] = [44, cr + ur * e.rows.length + lr], [c, l] = Vn([r, ...e.rows.flatMap((e) => e.outcomes).filter((e) => e !== null)]), u = .14 * (l - c), d = zn(c - u, l + u, !1, Math.max(2, Math.round((i - a - o) / 100))), f = (e) => a + d.part(e) * (i - a - o);
	return /* @__PURE__ */ z("figure", {
		class: "bars",
		"data-view": "tornado",
		children: [/* @__PURE__ */ z("svg", {
			width: i,
			height: s,
			role: "group",
			"aria-label": `How far each factor moves ${e.value} from ${q(r)} ${e.unit}`,
			children: [
				d.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
					class: "grid",
					x1: f(e),
					x2: f(e),
					y1: cr,
					y2: s - lr
				}), /* @__PURE__ */ z("text", {
					x: f(e),
					y: s - lr + 15,
					"text-anchor": "middle",
					children: q(e)
				})] })),
				e.rows.map((t, i) => /* @__PURE__ */ z("g", {
					transform: `translate(0,${cr + i * ur})`,
					"data-factor": t.path,
					children: [/* @__PURE__ */ z("text", {
						class: "what",
						x: a - 8,
						y: ur / 2 + 4,
						"text-anchor": "end",
						children: Wn(t.path, t.unit)
					}), t.outcomes.map((i, a) => {
						if (i === null) return /* @__PURE__ */ z("text", {
							x: f(r) + 4,
							y: ur / 2 + 4,
							children: "no value"
						});
						let o = i > r || i === r && a === 1, s = `${t.path} = ${q(t.ends[a])}: ${e.value} = ${q(i)}`, c = () => n(t.members[a]);
						return /* @__PURE__ */ z("g", {
							class: "bar " + (a ? "upper" : "lower"),
							role: "button",
							tabindex: 0,
							"aria-label": `${s}. Open this run.`,
							onClick: c,
							onKeyDown: (e) => e.key === "Enter" && c(),
							children: [/* @__PURE__ */ z("rect", {
								x: Math.min(f(i), f(r)),
								y: 5,
								width: Math.max(Math.abs(f(i) - f(r)), 1),
								height: ur - 10,
								"data-outcome": i,
								children: /* @__PURE__ */ z("title", { children: s })
							}), /* @__PURE__ */ z("text", {
								x: f(i) + (o ? 4 : -4),
								y: ur / 2 + 4,
								"text-anchor": o ? "start" : "end",
								children: q(t.ends[a])
							})]
						});
					})]
				})),
				/* @__PURE__ */ z("line", {
					class: "middle",
					x1: f(r),
					x2: f(r),
					y1: cr - 4,
					y2: s - lr
				}),
				/* @__PURE__ */ z("text", {
					x: f(r),
					y: cr - 9,
					"text-anchor": "middle",
					children: q(r)
				}),
				/* @__PURE__ */ z("text", {
					class: "what",
					x: (a + i - o) / 2,
					y: s - 6,
					"text-anchor": "middle",
					children: Wn(e.value, e.unit)
				})
			]
		}), /* @__PURE__ */ z("figcaption", { children: [/* @__PURE__ */ z("span", {
			class: "key",
			children: [/* @__PURE__ */ z("i", { class: "lower" }), " lower end of the factor"]
		}), /* @__PURE__ */ z("span", {
			class: "key",
			children: [/* @__PURE__ */ z("i", { class: "upper" }), " upper end"]
		})] })]
	});
}
function pr({ found: e, wide: t }) {
	let n = Math.min(t, 820), r = dr(e.rows.map((e) => e.path), n), [i, a] = [64, cr + ur * e.rows.length + lr], o = e.rows.flatMap((e) => [e.first, e.total].flatMap(([e, t]) => e === null ? [] : [e - (t ?? 0), e + (t ?? 0)]));
	if (!o.length) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "The outcome does not vary."
	});
	let [s, c] = Vn([0, ...o]), l = zn(s, Math.max(c, .1) * 1.02, !1, Math.max(2, Math.round((n - r - i) / 90))), u = (e) => r + l.part(e) * (n - r - i);
	return /* @__PURE__ */ z("figure", {
		class: "bars",
		"data-view": "sobol",
		children: [/* @__PURE__ */ z("svg", {
			width: n,
			height: a,
			role: "img",
			"aria-label": `Parts of the variance of ${e.value}: ${e.rows.map((e) => `${e.path} alone ${q(e.first[0])}, with others ${q(e.total[0])}`).join("; ")}`,
			children: [
				l.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
					class: "grid",
					x1: u(e),
					x2: u(e),
					y1: cr,
					y2: a - lr
				}), /* @__PURE__ */ z("text", {
					x: u(e),
					y: a - lr + 15,
					"text-anchor": "middle",
					children: q(e)
				})] })),
				e.rows.map((e, t) => /* @__PURE__ */ z("g", {
					transform: `translate(0,${cr + t * ur})`,
					"data-factor": e.path,
					children: [/* @__PURE__ */ z("text", {
						class: "what",
						x: r - 8,
						y: ur / 2 + 4,
						"text-anchor": "end",
						children: e.path
					}), [e.first, e.total].map(([e, t], n) => {
						if (e === null) return null;
						let r = 5 + n * 13, i = Math.max(u(e), u(e + (t ?? 0)));
						return /* @__PURE__ */ z("g", {
							class: "bar still " + (n ? "upper" : "lower"),
							children: [
								/* @__PURE__ */ z("rect", {
									x: Math.min(u(e), u(0)),
									y: r,
									width: Math.abs(u(e) - u(0)),
									height: 11,
									"data-index": e
								}),
								t !== null && /* @__PURE__ */ z("path", {
									class: "whisker",
									d: `M${u(e - t)},${r + 2}v7m0,-3.5H${u(e + t)}m0,-3.5v7`
								}),
								/* @__PURE__ */ z("text", {
									x: i + 5,
									y: r + 9,
									children: q(+e.toFixed(3))
								})
							]
						});
					})]
				})),
				/* @__PURE__ */ z("line", {
					class: "middle",
					x1: u(0),
					x2: u(0),
					y1: cr - 4,
					y2: a - lr
				}),
				/* @__PURE__ */ z("text", {
					class: "what",
					x: (r + n - i) / 2,
					y: a - 6,
					"text-anchor": "middle",
					children: ["part of the variance of ", e.value]
				})
			]
		}), /* @__PURE__ */ z("figcaption", { children: [
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { class: "lower" }), " alone"]
			}),
			/* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { class: "upper" }), " with others"]
			}),
			/* @__PURE__ */ z("small", { children: [
				e.points,
				" points, 95 % intervals",
				e.leftOut > 0 && `; ${e.leftOut} left out: a run failed`
			] })
		] })]
	});
}
// src/outcomes.tsx
var [mr, hr, gr, _r] = [
	66,
	12,
	10,
	38
], vr = 14;
function yr({ found: e, wide: t, high: n, dark: r, chosen: i, choose: a, open: o }) {
	let s = St(null), [c, l] = V(null), u = t > 620, [d, f] = [Math.max(t - (u ? 230 : 0), 160), n], [p, m] = [d - mr - hr, f - gr - _r], h = Bn(e.x, e.across, Math.max(2, Math.round(p / 90))), g = Bn(e.y, e.up, Math.max(2, Math.round(m / 50))), _ = e.across.length, v = e.x.edges && e.y.edges ? {
		x: e.x.edges,
		y: e.y.edges
	} : null, y = (e) => h.part(e) * p, b = (e) => (1 - g.part(e)) * m, x = (t) => v ? [e.across[t % _], e.up[Math.floor(t / _)]] : [e.across[t], e.up[t]], S = e.number.filter((e) => e !== null), [C, w] = Vn(S), T = (t) => t === null ? e.none : e.names.length ? e.inks[t] : Kn(w > C ? (t - C) / (w - C) : .5), E = (t) => e.number[t] === null ? "no value" : e.names.length ? e.names[e.number[t]] : q(e.number[t]);
	H(() => {
		let t = s.current, n = t?.getContext("2d");
		if (!t || !n) return;
		let r = devicePixelRatio || 1;
		[t.width, t.height] = [p * r, m * r], n.setTransform(r, 0, 0, r, 0, 0), n.clearRect(0, 0, p, m);
		let i = getComputedStyle(t).getPropertyValue("--off");
		e.number.forEach((t, a) => {
			if (e.members[a] < 0) return;
			if (n.fillStyle = T(t), v) {
				let [e, t] = [a % _, Math.floor(a / _)], [i, o] = [Math.round(y(v.x[e]) * r) / r, Math.round(y(v.x[e + 1]) * r) / r], [s, c] = [Math.round(b(v.y[t + 1]) * r) / r, Math.round(b(v.y[t]) * r) / r];
				n.fillRect(i, s, o - i, c - s);
				return;
			}
			let [o, s] = x(a);
			o !== null && s !== null && (n.beginPath(), n.arc(y(o), b(s), e.members.length > 2e3 ? 2 : 3.6, 0, 7), n.fill(), n.strokeStyle = i, n.lineWidth = .5, n.stroke());
		});
	}, [
		e,
		d,
		f,
		r
	]);
	let D = (t) => {
		let n = t.currentTarget.getBoundingClientRect(), [r, i] = [t.clientX - n.left, t.clientY - n.top];
		if (v) {
			let [t, n] = [v.x.findIndex((e) => y(e) > r) - 1, v.y.findIndex((e) => b(e) < i) - 1], a = n * _ + t;
			return t >= 0 && n >= 0 && e.members[a] >= 0 ? a : null;
		}
		let [a, o] = [-1, vr ** 2];
		return e.members.forEach((e, t) => {
			let [n, s] = x(t), c = n === null || s === null ? Infinity : (y(n) - r) ** 2 + (b(s) - i) ** 2;
			c < o && ([a, o] = [t, c]);
		}), a < 0 ? null : a;
	}, O = i === null ? -1 : e.members.indexOf(i), k = (t) => {
		if (t.key === "Enter" && i !== null) return o(i);
		let n = {
			ArrowRight: 1,
			ArrowLeft: -1,
			ArrowUp: v ? _ : 1,
			ArrowDown: v ? -_ : -1
		}[t.key];
		if (!n) return;
		t.preventDefault();
		let r = O < 0 ? 0 : O + n;
		e.members[r] >= 0 && a(e.members[r]);
	}, A = e.members.filter((e, t) => e >= 0 && !v && x(t).includes(null)).length, j = c ?? (O < 0 ? null : O), ee = (t) => {
		let [n, r] = x(t);
		return `run ${e.members[t]}: ${e.x.name} = ${q(n)}, ${e.y.name} = ${q(r)}, ${e.value} = ${E(t)}`;
	}, [te, ne] = O < 0 ? [null, null] : x(O);
	return /* @__PURE__ */ z("figure", {
		class: "outcomes" + (u ? " beside" : ""),
		"data-view": e.view,
		children: [/* @__PURE__ */ z("div", {
			class: "area",
			style: `width: ${d}px; height: ${f}px`,
			tabindex: 0,
			role: "group",
			"aria-label": `${e.value} over ${e.x.name} and ${e.y.name}, ${v ? "cells" : "points"}. Arrows choose a run, Enter opens it.`,
			onKeyDown: k,
			children: [/* @__PURE__ */ z("canvas", {
				ref: s,
				style: `left: ${mr}px; top: ${gr}px; width: ${p}px; height: ${m}px`,
				"data-span": JSON.stringify([
					h.low,
					h.high,
					g.low,
					g.high
				]),
				onMouseMove: (e) => l(D(e)),
				onMouseLeave: () => l(null),
				onClick: (t) => {
					let n = D(t);
					n !== null && (a(e.members[n]), o(e.members[n]));
				}
			}), /* @__PURE__ */ z("svg", {
				width: d,
				height: f,
				role: "img",
				"aria-label": `${e.value}: ${e.names.length ? e.names.join("; ") : `${q(C)} to ${q(w)} ${e.unit}`}`,
				children: [
					/* @__PURE__ */ z("rect", {
						class: "box",
						x: mr,
						y: gr,
						width: p,
						height: m
					}),
					h.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
						class: "tick",
						x1: mr + y(e),
						x2: mr + y(e),
						y1: gr + m,
						y2: gr + m + 4
					}), /* @__PURE__ */ z("text", {
						x: mr + y(e),
						y: gr + m + 15,
						"text-anchor": "middle",
						children: q(e)
					})] })),
					g.ticks.map((e) => /* @__PURE__ */ z("g", { children: [/* @__PURE__ */ z("line", {
						class: "tick",
						x1: mr - 4,
						x2: mr,
						y1: gr + b(e),
						y2: gr + b(e)
					}), /* @__PURE__ */ z("text", {
						x: mr - 7,
						y: gr + b(e) + 3.5,
						"text-anchor": "end",
						children: q(e)
					})] })),
					/* @__PURE__ */ z("text", {
						class: "what",
						x: mr + p / 2,
						y: f - 6,
						"text-anchor": "middle",
						children: Wn(e.x.name, e.x.unit)
					}),
					/* @__PURE__ */ z("text", {
						class: "what",
						transform: `translate(12,${gr + m / 2}) rotate(-90)`,
						"text-anchor": "middle",
						children: Wn(e.y.name, e.y.unit)
					}),
					te !== null && ne !== null && /* @__PURE__ */ z("circle", {
						class: "chosen",
						cx: mr + y(te),
						cy: gr + b(ne),
						r: 7
					})
				]
			})]
		}), /* @__PURE__ */ z("figcaption", { children: [
			/* @__PURE__ */ z("b", { children: Wn(e.value, e.unit) }),
			e.names.map((t, n) => /* @__PURE__ */ z("span", {
				class: "key",
				children: [
					/* @__PURE__ */ z("i", { style: `background: ${e.inks[n]}` }),
					" ",
					t
				]
			})),
			!e.names.length && S.length > 0 && /* @__PURE__ */ z("span", {
				class: "bar",
				children: [
					/* @__PURE__ */ z("i", { style: `background: linear-gradient(to right, ${qn})` }),
					/* @__PURE__ */ z("span", { children: q(C) }),
					/* @__PURE__ */ z("span", { children: q(w) })
				]
			}),
			!e.names.length && e.members.some((t, n) => t >= 0 && e.number[n] === null) && /* @__PURE__ */ z("span", {
				class: "key",
				children: [/* @__PURE__ */ z("i", { style: `background: ${e.none}` }), " no value"]
			}),
			e.members.length < e.all && /* @__PURE__ */ z("small", { children: [
				e.members.length,
				" of ",
				e.all,
				" runs are drawn"
			] }),
			A > 0 && /* @__PURE__ */ z("small", { children: [A === 1 ? "1 run has" : `${A} runs have`, " no value for an axis"] }),
			/* @__PURE__ */ z("output", { children: j !== null && e.members[j] >= 0 ? ee(j) : "" })
		] })]
	});
}
// src/planned.tsx
var br = [
	["map", "Map"],
	["scatter", "Scatter"],
	["family", "Curves"],
	["tornado", "Tornado"],
	["sobol", "Sobol indices"],
	["table", "Table"]
], xr = 92, Sr = "(max-width: 760px)", Cr = 500, wr = 4;
function Tr({ store: e, state: t, plan: n }) {
	let { choice: r, chosen: i } = t.looked?.plan === n.plan ? t.looked : {
		choice: Nr(n),
		chosen: null
	}, [[a, o], s] = V([700, 340]), c = St(null);
	H(() => {
		let e = c.current;
		if (!e) return;
		let t = new ResizeObserver(() => s([Math.max(260, e.clientWidth - 24), matchMedia(Sr).matches ? 0 : e.clientHeight]));
		return t.observe(e), () => t.disconnect();
	}, []);
	let l = (t) => e.set({ looked: {
		plan: n.plan,
		choice: {
			...r,
			...t
		},
		chosen: i
	} }), u = (t) => e.set({ looked: {
		plan: n.plan,
		choice: r,
		chosen: t
	} }), d = [...n.factors.filter((e) => e.number).map((e) => e.path), ...n.columns.filter((e) => e.kind === "number" || e.kind === "whole").map((e) => e.name)], f = n.columns.filter((e) => e.kind !== "curve").map((e) => e.name), p = (e, t, n) => /* @__PURE__ */ z("label", { children: [e, /* @__PURE__ */ z("select", {
		"aria-label": e,
		value: r[t],
		onChange: (e) => l({ [t]: e.currentTarget.value }),
		children: n.map((e) => /* @__PURE__ */ z("option", { children: e }))
	})] }), m = (t) => void e.openMember(t), h = o ? Math.max(o - xr, 190) : Math.round(Math.min(.8 * a, 340)), g = n.factors.map((e) => e.path), _ = n.way === "grid" && r.view === "map" ? n.factors.filter((e) => e.levels.length > 1 && e.path !== r.x && e.path !== r.y) : [], v = _.length > 0 && g.includes(r.x) && g.includes(r.y), y = v ? Object.fromEntries(_.map((e) => [e.path, r.at[e.path] ?? 0])) : {}, [b, S] = Pr(e, n, {
		...r,
		at: y
	});
	return /* @__PURE__ */ z("section", {
		class: "plots planned",
		ref: c,
		"aria-label": "Sweep",
		children: [
			/* @__PURE__ */ z("div", {
				class: "plotbar",
				children: [
					/* @__PURE__ */ z(Dr, {
						store: e,
						plan: n
					}),
					/* @__PURE__ */ z(Or, {
						store: e,
						plan: n,
						chosen: i,
						choose: u,
						open: m
					}),
					/* @__PURE__ */ z("button", {
						onClick: () => void Fr(e, n),
						disabled: !n.kept,
						children: "Table as CSV"
					}),
					/* @__PURE__ */ z("button", {
						onClick: () => e.set({ planShown: !1 }),
						children: "Plots"
					})
				]
			}),
			/* @__PURE__ */ z("div", {
				class: "plotbar",
				children: [
					/* @__PURE__ */ z("div", {
						class: "choices",
						role: "group",
						"aria-label": "Views",
						children: br.map(([e, t]) => /* @__PURE__ */ z("button", {
							"aria-pressed": r.view === e,
							onClick: () => l({
								view: e,
								...Mr(n, e)
							}),
							children: t
						}))
					}),
					(r.view === "map" || r.view === "scatter") && /* @__PURE__ */ z(x, { children: [
						p("of", "value", r.view === "map" ? f : [
							...f,
							"status",
							...g
						]),
						p("across", "x", d),
						p("up", "y", d)
					] }),
					r.view === "family" && p("of", "curve", n.columns.filter((e) => e.kind === "curve").map((e) => e.name)),
					(r.view === "tornado" || r.view === "sobol") && p("of", "value", d.filter((e) => !g.includes(e))),
					v && _.map((e) => /* @__PURE__ */ z("label", { children: [e.path, /* @__PURE__ */ z("select", {
						"aria-label": `Level of ${e.path}`,
						value: y[e.path],
						onChange: (t) => l({ at: {
							...r.at,
							[e.path]: Number(t.currentTarget.value)
						} }),
						children: e.levels.map((e, t) => /* @__PURE__ */ z("option", {
							value: t,
							children: e
						}))
					})] }))
				]
			}),
			n.error && /* @__PURE__ */ z("p", {
				class: "wrong",
				children: [
					n.error.code,
					" ",
					n.error.where,
					" ",
					n.error.why,
					" ",
					/* @__PURE__ */ z("em", { children: n.error.try })
				]
			}),
			S ? /* @__PURE__ */ z("p", {
				class: "hint",
				children: [
					S.why,
					". ",
					Er(n, r.view) || S.try
				]
			}) : b ? b.view === "table" ? /* @__PURE__ */ z(kr, {
				found: b,
				open: m,
				turn: (e) => l({ first: e })
			}) : b.view === "family" ? /* @__PURE__ */ z(sr, {
				found: b,
				wide: Math.min(a, 4 * h),
				high: h,
				chosen: i,
				choose: u,
				open: m
			}) : b.view === "tornado" ? /* @__PURE__ */ z(fr, {
				found: b,
				wide: a,
				open: m
			}) : b.view === "sobol" ? /* @__PURE__ */ z(pr, {
				found: b,
				wide: a
			}) : /* @__PURE__ */ z(yr, {
				found: b,
				wide: Math.min(a, 4 * h),
				high: h,
				dark: t.dark,
				chosen: i,
				choose: u,
				open: m
			}) : /* @__PURE__ */ z("p", {
				class: "hint",
				children: n.kept ? "…" : n.state === "running" ? "The first runs are on their way …" : "No run was done."
			})
		]
	});
}
function Er(e, t) {
	let n = e.way.split(":")[0];
	return t === "tornado" && n !== "ends" ? "Draw members ‘for a tornado’." : t === "sobol" && n !== "saltelli" ? "Draw members ‘for Sobol indices’." : t === "family" && !e.columns.some((e) => e.kind === "curve") ? "Collect a curve: curve(height, 101)." : "";
}
function Dr({ store: e, plan: t }) {
	let n = t.left === null ? "" : t.left < 1 ? ", under 1 s to go" : t.left < 120 ? `, ${Math.round(t.left)} s to go` : t.left < 7200 ? `, ${Math.round(t.left / 60)} min to go` : `, ${(t.left / 3600).toFixed(1)} h to go`, r = t.factors.map((e) => e.path).join(", ");
	return t.state === "running" ? /* @__PURE__ */ z(x, { children: [
		/* @__PURE__ */ z("progress", {
			"aria-label": "Progress of the sweep",
			max: t.members,
			value: t.done
		}),
		/* @__PURE__ */ z("span", { children: [
			t.done,
			" of ",
			t.members,
			" runs",
			n
		] }),
		/* @__PURE__ */ z("button", {
			onClick: () => void e.transport.ask("plan cancel").catch(() => {}),
			children: "Cancel"
		})
	] }) : /* @__PURE__ */ z("span", {
		role: "status",
		children: [
			/* @__PURE__ */ z("b", { children: r }),
			": ",
			t.state === "done" ? `${t.members} runs` : `${t.kept} of ${t.members} runs, ${t.state === "cancelled" ? "cancelled" : "stopped"}`
		]
	});
}
function Or({ store: e, plan: t, chosen: n, choose: r, open: i }) {
	let [a, o] = V(null);
	H(() => {
		if (o(null), n === null) return;
		let r = !1;
		return e.transport.ask("plan member", {
			plan: t.plan,
			member: n
		}).then((e) => !r && o(e)).catch((t) => e.refused(t)), () => {
			r = !0;
		};
	}, [
		n,
		t.plan,
		t.state
	]);
	let s = a && a.member === n ? Object.entries(a.sets) : [], c = e.state.look?.panels.parameters ?? {}, l = async () => {
		for (let [t, n] of s) if (!await e.edit({
			do: "set",
			path: ["parameters", t],
			value: n,
			level: ""
		})) return;
		await e.start();
	};
	return /* @__PURE__ */ z("div", {
		class: "plotbar one",
		children: [/* @__PURE__ */ z("label", { children: ["run", /* @__PURE__ */ z("input", {
			type: "number",
			"aria-label": "Run of the sweep",
			min: 0,
			max: t.members - 1,
			value: n ?? "",
			onKeyDown: (e) => (e.stopPropagation(), e.key === "Enter" && n !== null && i(n)),
			onInput: (e) => {
				let n = Number(e.currentTarget.value);
				e.currentTarget.value && Number.isInteger(n) && n >= 0 && n < t.members && r(n);
			}
		})] }), n !== null && /* @__PURE__ */ z(x, { children: [
			/* @__PURE__ */ z("output", { children: [
				s.map(([e, t]) => `${e} = ${jr(t)}`).join(", "),
				a?.row && t.columns.filter((e) => e.kind !== "curve").map((e) => `; ${e.name} = ${Ar(a.row[e.name])}`).join(""),
				a?.row?.code && `; ${a.row.status}: ${a.row.code} ${a.row.message}`
			] }),
			/* @__PURE__ */ z("button", {
				onClick: () => i(n),
				children: "Open"
			}),
			s.length > 0 && s.every(([e]) => e in c) && /* @__PURE__ */ z("button", {
				onClick: () => void l(),
				children: "Take these values"
			})
		] })]
	});
}
function kr({ found: e, open: t, turn: n }) {
	let r = e.columns.map((e, t) => t).filter((t) => t === 0 || ![
		"code",
		"message",
		"warnings"
	].includes(e.columns[t].name) || e.rows.some((e) => e[t])), i = new Set(r.filter((t) => e.rows.some((e) => typeof e[t] == "number"))), a = e.first + e.rows.length;
	return /* @__PURE__ */ z("div", {
		class: "rows",
		children: [/* @__PURE__ */ z("div", {
			class: "tables",
			tabindex: 0,
			role: "region",
			"aria-label": "Table of the sweep",
			children: /* @__PURE__ */ z("table", { children: [/* @__PURE__ */ z("thead", { children: /* @__PURE__ */ z("tr", { children: r.map((t) => /* @__PURE__ */ z("th", {
				scope: "col",
				class: i.has(t) ? "figure" : "",
				children: [e.columns[t].name, e.columns[t].unit && ` [${e.columns[t].unit}]`]
			})) }) }), /* @__PURE__ */ z("tbody", { children: e.rows.map((e) => /* @__PURE__ */ z("tr", { children: r.map((n) => /* @__PURE__ */ z("td", {
				class: i.has(n) ? "figure" : "",
				children: n === 0 ? /* @__PURE__ */ z("button", {
					class: "link",
					onClick: () => t(Number(e[0])),
					children: e[0]
				}) : Ar(e[n])
			})) })) })] })
		}), /* @__PURE__ */ z("div", {
			class: "plotbar",
			children: [
				/* @__PURE__ */ z("button", {
					disabled: !e.first,
					onClick: () => n(Math.max(e.first - 200, 0)),
					children: "Before"
				}),
				/* @__PURE__ */ z("span", { children: [
					e.first,
					" to ",
					a - 1,
					" of ",
					e.kept
				] }),
				/* @__PURE__ */ z("button", {
					disabled: a >= e.kept,
					onClick: () => n(a),
					children: "After"
				})
			]
		})]
	});
}
function Ar(e) {
	return typeof e == "number" ? q(e) : e ?? "none";
}
function jr(e) {
	let [t, ...n] = String(e).split(" ");
	return Number.isFinite(Number(t)) ? [q(Number(t)), ...n].join(" ") : String(e);
}
function Mr(e, t) {
	let n = e.factors.filter((e) => e.number).map((e) => e.path), r = e.columns.filter((e) => e.kind === "number" || e.kind === "whole").map((e) => e.name), i = e.columns.filter((e) => e.kind === "text").map((e) => e.name), [a = "", o = n[0] ?? ""] = n;
	switch (t) {
		case "map": return {
			value: i.includes("sequence") ? "sequence" : r[0] ?? i[0] ?? "",
			x: a,
			y: o
		};
		case "scatter": return {
			value: i[0] ?? "status",
			x: r.length > 1 ? r[0] : a,
			y: r[1] ?? r[0] ?? o
		};
		case "family": return { curve: e.columns.find((e) => e.kind === "curve")?.name ?? "" };
		default: return { value: r[0] ?? "" };
	}
}
function Nr(e) {
	let t = e.way.split(":")[0], n = e.columns.find((e) => e.kind === "curve"), r = e.factors.filter((e) => e.number).length, i = t === "ends" ? "tornado" : t === "saltelli" ? "sobol" : n && (r < 2 || e.columns.length === 1) ? "family" : r < 2 ? "scatter" : "map";
	return {
		view: i,
		x: "",
		y: "",
		value: "",
		curve: "",
		at: {},
		first: 0,
		...Mr(e, i)
	};
}
function Pr(e, t, n) {
	let [r, i] = V({
		key: "",
		seen: null,
		refused: null
	}), a = JSON.stringify([t.plan, n]), o = St({
		key: "",
		kept: -1,
		ended: !1
	}), s = St(!1), c = St(!1), l = async () => {
		if (s.current) return;
		s.current = !0;
		let t = "";
		for (; !c.current && JSON.stringify(o.current) !== t;) {
			let n = o.current;
			t = JSON.stringify(n);
			let [r, a] = JSON.parse(n.key), s = performance.now();
			try {
				let t = await e.transport.ask("plan view", {
					plan: r,
					...a
				});
				n.key === o.current.key && i({
					key: n.key,
					seen: t,
					refused: null
				});
			} catch (e) {
				let t = e.problem ?? null;
				n.key === o.current.key && i({
					key: n.key,
					seen: null,
					refused: t
				});
			}
			let c = n.key === o.current.key, l = Math.max(Cr, wr * (performance.now() - s));
			c && !o.current.ended && await new Promise((e) => setTimeout(e, l));
		}
		s.current = !1;
	};
	return H(() => (c.current = !1, () => {
		c.current = !0;
	}), []), H(() => {
		o.current = {
			key: a,
			kept: t.kept,
			ended: t.state !== "running"
		}, t.kept && l();
	}, [
		a,
		t.kept,
		t.state
	]), [r.seen && JSON.parse(r.key || "[]")[0] === t.plan && r.seen.view === n.view ? r.seen : null, r.key === a ? r.refused : null];
}
async function Fr(e, t) {
	try {
		let { text: n, name: r } = await e.transport.ask("plan csv", { plan: t.plan }), i = document.createElement("a");
		i.href = URL.createObjectURL(new Blob([n], { type: "text/csv" })), i.download = r, i.click(), URL.revokeObjectURL(i.href);
	} catch (t) {
		e.refused(t);
	}
}
// node_modules/uplot/dist/uPlot.esm.js
var Ir = !0, Lr = "uplot", Rr = "u-hz", zr = "u-vt", Br = "u-title", Vr = "u-wrap", Hr = "u-under", Ur = "u-over", Wr = "u-axis", Gr = "u-off", Kr = "u-select", qr = "u-cursor-x", Jr = "u-cursor-y", Yr = "u-cursor-pt", Xr = "u-legend", Zr = "u-live", Qr = "u-inline", $r = "u-series", ei = "u-marker", ti = "u-label", ni = "u-value", ri = "width", ii = "height", ai = "top", oi = "bottom", si = "left", ci = "right", li = "#000", ui = "#0000", di = "mousemove", fi = "mousedown", pi = "mouseup", mi = "mouseenter", hi = "mouseleave", gi = "dblclick", _i = "resize", vi = "scroll", yi = "change", bi = "dppxchange", xi = "--", Si = typeof window < "u", Ci = Si ? document : null, wi = Si ? window : null, Ti = Si ? navigator : null, J, Ei;
function Di() {
	let e = devicePixelRatio;
	J != e && (J = e, Ei && Hi(yi, Ei, Di), Ei = matchMedia(`(min-resolution: ${J - .001}dppx) and (max-resolution: ${J + .001}dppx)`), Vi(yi, Ei, Di), wi.dispatchEvent(new CustomEvent(bi)));
}
function Oi(e, t) {
	if (t != null) {
		let n = e.classList;
		!n.contains(t) && n.add(t);
	}
}
function ki(e, t) {
	let n = e.classList;
	n.contains(t) && n.remove(t);
}
function Ai(e, t, n) {
	e.style[t] = n + "px";
}
function ji(e, t, n, r) {
	let i = Ci.createElement(e);
	return t != null && Oi(i, t), n?.insertBefore(i, r), i;
}
function Mi(e, t) {
	return ji("div", e, t);
}
var Ni = /* @__PURE__ */ new WeakMap();
function Pi(e, t, n, r, i) {
	let a = "translate(" + t + "px," + n + "px)";
	a != Ni.get(e) && (e.style.transform = a, Ni.set(e, a), t < 0 || n < 0 || t > r || n > i ? Oi(e, Gr) : ki(e, Gr));
}
var Fi = /* @__PURE__ */ new WeakMap();
function Ii(e, t, n) {
	let r = t + n;
	r != Fi.get(e) && (Fi.set(e, r), e.style.background = t, e.style.borderColor = n);
}
var Li = /* @__PURE__ */ new WeakMap();
function Ri(e, t, n, r) {
	let i = t + "" + n;
	i != Li.get(e) && (Li.set(e, i), e.style.height = n + "px", e.style.width = t + "px", e.style.marginLeft = r ? -t / 2 + "px" : 0, e.style.marginTop = r ? -n / 2 + "px" : 0);
}
var zi = { passive: !0 }, Bi = {
	...zi,
	capture: !0
};
function Vi(e, t, n, r) {
	t.addEventListener(e, n, r ? Bi : zi);
}
function Hi(e, t, n, r) {
	t.removeEventListener(e, n, zi);
}
Si && Di();
function Ui(e, t, n, r) {
	let i;
	n ||= 0, r ||= t.length - 1;
	let a = r <= 2147483647;
	for (; r - n > 1;) i = a ? n + r >> 1 : ua((n + r) / 2), t[i] < e ? n = i : r = i;
	return e - t[n] <= t[r] - e ? n : r;
}
function Wi(e) {
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
var Gi = (e) => e != null, Ki = (e) => e != null && e > 0, qi = Wi(Gi), Ji = Wi(Ki);
function Yi(e, t, n, r = 0, i = !1) {
	let a = i ? Ji : qi, o = i ? Ki : Gi;
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
	return [s ?? xa, c ?? -xa];
}
function Xi(e, t, n, r) {
	let i = ga(e), a = ga(t);
	e == t && (i == -1 ? (e *= n, t /= n) : (e /= n, t *= n));
	let o = n == 10 ? _a : va, s = i == 1 ? ua : fa, c = a == 1 ? fa : ua, l = s(o(la(e))), u = c(o(la(t))), d = ha(n, l), f = ha(n, u);
	return n == 10 && (l < 0 && (d = Z(d, -l)), u < 0 && (f = Z(f, -u))), r || n == 2 ? (e = d * i, t = f * a) : (e = Fa(e, d), t = Pa(t, f)), [e, t];
}
function Zi(e, t, n, r) {
	let i = Xi(e, t, n, r);
	return e == 0 && (i[0] = 0), t == 0 && (i[1] = 0), i;
}
var Qi = .1, $i = {
	mode: 3,
	pad: Qi
}, ea = {
	pad: 0,
	soft: null,
	mode: 0
}, ta = {
	min: ea,
	max: ea
};
function na(e, t, n, r) {
	return Ka(n) ? ia(e, t, n) : (ea.pad = n, ea.soft = r ? 0 : null, ea.mode = r ? 3 : 0, ia(e, t, ta));
}
function Y(e, t) {
	return e ?? t;
}
function ra(e, t, n) {
	for (t = Y(t, 0), n = Y(n, e.length - 1); t <= n;) {
		if (e[t] != null) return !0;
		t++;
	}
	return !1;
}
function ia(e, t, n) {
	let r = n.min, i = n.max, a = Y(r.pad, 0), o = Y(i.pad, 0), s = Y(r.hard, -xa), c = Y(i.hard, xa), l = Y(r.soft, xa), u = Y(i.soft, -xa), d = Y(r.mode, 0), f = Y(i.mode, 0), p = t - e, m = _a(p), h = ma(la(e), la(t)), g = la(_a(h) - m);
	(p < 1e-24 || g > 10) && (p = 0, (e == 0 || t == 0) && (p = 1e-24, d == 2 && l != xa && (a = 0), f == 2 && u != -xa && (o = 0)));
	let _ = p || h || 1e3, v = ha(10, ua(_a(_))), y = Z(Fa(e - _ * (p == 0 ? e == 0 ? .1 : 1 : a), v / 10), 24), b = e >= l && (d == 1 || d == 3 && y <= l || d == 2 && y >= l) ? l : xa, x = ma(s, y < b && e >= b ? b : pa(b, y)), S = Z(Pa(t + _ * (p == 0 ? t == 0 ? .1 : 1 : o), v / 10), 24), C = t <= u && (f == 1 || f == 3 && S >= u || f == 2 && S <= u) ? u : -xa, w = pa(c, S > C && t <= C ? C : ma(C, S));
	return x == w && x == 0 && (w = 100), [x, w];
}
var aa = new Intl.NumberFormat(Si ? Ti.language : "en-US"), oa = (e) => aa.format(e), sa = Math, ca = sa.PI, la = sa.abs, ua = sa.floor, da = sa.round, fa = sa.ceil, pa = sa.min, ma = sa.max, ha = sa.pow, ga = sa.sign, _a = sa.log10, va = sa.log2, ya = (e, t = 1) => sa.sinh(e) * t, ba = (e, t = 1) => sa.asinh(e / t), xa = Infinity;
function Sa(e) {
	return (_a((e ^ e >> 31) - (e >> 31)) | 0) + 1;
}
function Ca(e, t, n) {
	return pa(ma(e, t), n);
}
function wa(e) {
	return typeof e == "function";
}
function X(e) {
	return wa(e) ? e : () => e;
}
var Ta = () => {}, Ea = (e) => e, Da = (e, t) => t, Oa = (e) => null, ka = (e) => !0, Aa = (e, t) => e == t, ja = /\.\d*?(?=9{6,}|0{6,})/gm, Ma = (e) => {
	if (Ua(e) || Ia.has(e)) return e;
	let t = `${e}`, n = t.match(ja);
	if (n == null) return e;
	let r = n[0].length - 1;
	if (t.indexOf("e-") != -1) {
		let [e, n] = t.split("e");
		return +`${Ma(e)}e${n}`;
	}
	return Z(e, r);
};
function Na(e, t) {
	return Ma(Z(Ma(e / t)) * t);
}
function Pa(e, t) {
	return Ma(fa(Ma(e / t)) * t);
}
function Fa(e, t) {
	return Ma(ua(Ma(e / t)) * t);
}
function Z(e, t = 0) {
	if (Ua(e)) return e;
	let n = 10 ** t;
	return da(e * n * (1 + 2 ** -52)) / n;
}
var Ia = /* @__PURE__ */ new Map();
function La(e) {
	return (("" + e).split(".")[1] || "").length;
}
function Ra(e, t, n, r) {
	let i = [], a = r.map(La);
	for (let o = t; o < n; o++) {
		let t = la(o), n = Z(ha(e, o), t);
		for (let s = 0; s < r.length; s++) {
			let c = e == 10 ? +`${r[s]}e${o}` : r[s] * n, l = (o >= 0 ? 0 : t) + (o >= a[s] ? 0 : a[s]), u = e == 10 ? c : Z(c, l);
			i.push(u), Ia.set(u, l);
		}
	}
	return i;
}
var za = {}, Ba = [], Va = [null, null], Ha = Array.isArray, Ua = Number.isInteger, Wa = (e) => e === void 0;
function Ga(e) {
	return typeof e == "string";
}
function Ka(e) {
	let t = !1;
	if (e != null) {
		let n = e.constructor;
		t = n == null || n == Object;
	}
	return t;
}
function qa(e) {
	return typeof e == "object" && !!e;
}
var Ja = Object.getPrototypeOf(Uint8Array), Ya = "__proto__";
function Xa(e, t = Ka) {
	let n;
	if (Ha(e)) {
		let r = e.find((e) => e != null);
		if (Ha(r) || t(r)) {
			n = Array(e.length);
			for (let r = 0; r < e.length; r++) n[r] = Xa(e[r], t);
		} else n = e.slice();
	} else if (e instanceof Ja) n = e.slice();
	else if (t(e)) {
		n = {};
		for (let r in e) r != Ya && (n[r] = Xa(e[r], t));
	} else n = e;
	return n;
}
function Za(e) {
	let t = arguments;
	for (let n = 1; n < t.length; n++) {
		let r = t[n];
		for (let t in r) t != Ya && (Ka(e[t]) ? Za(e[t], Xa(r[t])) : e[t] = Xa(r[t]));
	}
	return e;
}
var Qa = 0, $a = 1, eo = 2;
function to(e, t, n) {
	for (let r = 0, i, a = -1; r < t.length; r++) {
		let o = t[r];
		if (o > a) {
			for (i = o - 1; i >= 0 && e[i] == null;) e[i--] = null;
			for (i = o + 1; i < n && e[i] == null;) e[a = i++] = null;
		}
	}
}
function no(e, t) {
	if (ao(e)) {
		let t = e[0].slice();
		for (let n = 1; n < e.length; n++) t.push(...e[n].slice(1));
		return oo(t[0]) || (t = io(t)), t;
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
			let c = o[e], l = Array(i).fill(void 0), u = t ? t[n][e] : $a, d = [];
			for (let e = 0; e < c.length; e++) {
				let t = c[e], n = a.get(s[e]);
				t === null ? u != Qa && (l[n] = t, u == eo && d.push(n)) : l[n] = t;
			}
			to(l, d, i), r.push(l);
		}
	}
	return r;
}
var ro = typeof queueMicrotask > "u" ? (e) => Promise.resolve().then(e) : queueMicrotask;
function io(e) {
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
function ao(e) {
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
function oo(e, t = 100) {
	let n = e.length;
	if (n <= 1) return !0;
	let r = 0, i = n - 1;
	for (; r <= i && e[r] == null;) r++;
	for (; i >= r && e[i] == null;) i--;
	if (i <= r) return !0;
	let a = ma(1, ua((i - r + 1) / t));
	for (let t = e[r], n = r + a; n <= i; n += a) {
		let r = e[n];
		if (r != null) {
			if (r <= t) return !1;
			t = r;
		}
	}
	return !0;
}
var so = [
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
], co = [
	"Sunday",
	"Monday",
	"Tuesday",
	"Wednesday",
	"Thursday",
	"Friday",
	"Saturday"
];
function lo(e) {
	return e.slice(0, 3);
}
var uo = co.map(lo), fo = {
	MMMM: so,
	MMM: so.map(lo),
	WWWW: co,
	WWW: uo
};
function po(e) {
	return (e < 10 ? "0" : "") + e;
}
function mo(e) {
	return (e < 10 ? "00" : e < 100 ? "0" : "") + e;
}
var ho = {
	YYYY: (e) => e.getFullYear(),
	YY: (e) => (e.getFullYear() + "").slice(2),
	MMMM: (e, t) => t.MMMM[e.getMonth()],
	MMM: (e, t) => t.MMM[e.getMonth()],
	MM: (e) => po(e.getMonth() + 1),
	M: (e) => e.getMonth() + 1,
	DD: (e) => po(e.getDate()),
	D: (e) => e.getDate(),
	WWWW: (e, t) => t.WWWW[e.getDay()],
	WWW: (e, t) => t.WWW[e.getDay()],
	HH: (e) => po(e.getHours()),
	H: (e) => e.getHours(),
	h: (e) => {
		let t = e.getHours();
		return t == 0 ? 12 : t > 12 ? t - 12 : t;
	},
	AA: (e) => e.getHours() >= 12 ? "PM" : "AM",
	aa: (e) => e.getHours() >= 12 ? "pm" : "am",
	a: (e) => e.getHours() >= 12 ? "p" : "a",
	mm: (e) => po(e.getMinutes()),
	m: (e) => e.getMinutes(),
	ss: (e) => po(e.getSeconds()),
	s: (e) => e.getSeconds(),
	fff: (e) => mo(e.getMilliseconds())
};
function go(e, t) {
	t ||= fo;
	let n = [], r = /\{([a-z]+)\}|[^{]+/gi, i;
	for (; i = r.exec(e);) n.push(i[0][0] == "{" ? ho[i[1]] : i[0]);
	return (e) => {
		let r = "";
		for (let i = 0; i < n.length; i++) r += typeof n[i] == "string" ? n[i] : n[i](e, t);
		return r;
	};
}
var _o = new Intl.DateTimeFormat().resolvedOptions().timeZone;
function vo(e, t) {
	let n;
	return t == "UTC" || t == "Etc/UTC" ? n = /* @__PURE__ */ new Date(+e + e.getTimezoneOffset() * 6e4) : t == _o ? n = e : (n = new Date(e.toLocaleString("en-US", { timeZone: t })), n.setMilliseconds(e.getMilliseconds())), n;
}
var yo = (e) => e % 1 == 0, bo = [
	1,
	2,
	2.5,
	5
], xo = Ra(10, -32, 0, bo), So = Ra(10, 0, 32, bo), Co = So.filter(yo), wo = xo.concat(So), To = "\n", Eo = "{YYYY}", Do = To + Eo, Oo = "{M}/{D}", ko = To + Oo, Ao = ko + "/{YY}", jo = "{aa}", Mo = "{h}:{mm}" + jo, No = To + Mo, Po = ":{ss}", Q = null;
function Fo(e) {
	let t = e * 1e3, n = t * 60, r = n * 60, i = r * 24, a = i * 30, o = i * 365, s = (e == 1 ? Ra(10, 0, 3, bo).filter(yo) : Ra(10, -3, 0, bo)).concat([
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
			Eo,
			Q,
			Q,
			Q,
			Q,
			Q,
			Q,
			1
		],
		[
			i * 28,
			"{MMM}",
			Do,
			Q,
			Q,
			Q,
			Q,
			Q,
			1
		],
		[
			i,
			Oo,
			Do,
			Q,
			Q,
			Q,
			Q,
			Q,
			1
		],
		[
			r,
			"{h}" + jo,
			Ao,
			Q,
			ko,
			Q,
			Q,
			Q,
			1
		],
		[
			n,
			Mo,
			Ao,
			Q,
			ko,
			Q,
			Q,
			Q,
			1
		],
		[
			t,
			Po,
			Ao + " " + Mo,
			Q,
			ko + " " + Mo,
			Q,
			No,
			Q,
			1
		],
		[
			e,
			Po + ".{fff}",
			Ao + " " + Mo,
			Q,
			ko + " " + Mo,
			Q,
			No,
			Q,
			1
		]
	];
	function l(t) {
		return (s, c, l, u, d, f) => {
			let p = [], m = d >= o, h = d >= a && d < o, g = t(l), _ = Z(g * e, 3), v = Go(g.getFullYear(), m ? 0 : g.getMonth(), h || m ? 1 : g.getDate()), y = Z(v * e, 3);
			if (h || m) {
				let n = h ? d / a : 0, r = m ? d / o : 0, i = _ == y ? _ : Z(Go(v.getFullYear() + r, v.getMonth() + n, 1) * e, 3), s = new Date(da(i / e)), c = s.getFullYear(), l = s.getMonth();
				for (let a = 0; i <= u; a++) {
					let o = Go(c + r * a, l + n * a, 1), s = o - t(Z(o * e, 3));
					i = Z((+o + s) * e, 3), i <= u && p.push(i);
				}
			} else {
				let a = d >= i ? i : d, o = y + (ua(l) - ua(_)) + Pa(_ - y, a);
				p.push(o);
				let m = t(o), h = m.getHours() + m.getMinutes() / n + m.getSeconds() / r, g = d / r, v = f / s.axes[c]._space;
				for (; o = Z(o + d, e == 1 ? 0 : 3), !(o > u);) if (g > 1) {
					let e = ua(Z(h + g, 6)) % 24, n = t(o).getHours() - e;
					n > 1 && (n = -1), o -= n * r, h = (h + g) % 24;
					let i = p[p.length - 1];
					Z((o - i) / d, 3) * v >= .7 && p.push(o);
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
var [Io, Lo, Ro] = Fo(1), [zo, Bo, Vo] = Fo(.001);
Ra(2, -53, 53, [1]);
function Ho(e, t) {
	return e.map((e) => e.map((n, r) => r == 0 || r == 8 || n == null ? n : t(r == 1 || e[8] == 0 ? n : e[1] + n)));
}
function Uo(e, t) {
	return (n, r, i, a, o) => {
		let s = t.find((e) => o >= e[0]) || t[t.length - 1], c, l, u, d, f, p;
		return r.map((t) => {
			let n = e(t), r = n.getFullYear(), i = n.getMonth(), a = n.getDate(), o = n.getHours(), m = n.getMinutes(), h = n.getSeconds(), g = r != c && s[2] || i != l && s[3] || a != u && s[4] || o != d && s[5] || m != f && s[6] || h != p && s[7] || s[1];
			return c = r, l = i, u = a, d = o, f = m, p = h, g(n);
		});
	};
}
function Wo(e, t) {
	let n = go(t);
	return (t, r, i, a, o) => r.map((t) => n(e(t)));
}
function Go(e, t, n) {
	return new Date(e, t, n);
}
function Ko(e, t) {
	return t(e);
}
var qo = "{YYYY}-{MM}-{DD} {h}:{mm}{aa}";
function Jo(e, t) {
	return (n, r, i, a) => a == null ? xi : t(e(r));
}
function Yo(e, t) {
	let n = e.series[t];
	return n.width ? n.stroke(e, t) : n.points.width ? n.points.stroke(e, t) : null;
}
function Xo(e, t) {
	return e.series[t].fill(e, t);
}
var Zo = {
	show: !0,
	live: !0,
	isolate: !1,
	mount: Ta,
	markers: {
		show: !0,
		width: 2,
		stroke: Yo,
		fill: Xo,
		dash: "solid"
	},
	idx: null,
	idxs: null,
	values: []
};
function Qo(e, t) {
	let n = e.cursor.points, r = Mi(), i = n.size(e, t);
	Ai(r, ri, i), Ai(r, ii, i);
	let a = i / -2;
	Ai(r, "marginLeft", a), Ai(r, "marginTop", a);
	let o = n.width(e, t, i);
	return o && Ai(r, "borderWidth", o), r;
}
function $o(e, t) {
	let n = e.series[t].points;
	return n._fill || n._stroke;
}
function es(e, t) {
	let n = e.series[t].points;
	return n._stroke || n._fill;
}
function ts(e, t) {
	return e.series[t].points.size;
}
var ns = [0, 0];
function rs(e, t, n) {
	return ns[0] = t, ns[1] = n, ns;
}
function is(e, t, n, r = !0) {
	return (e) => {
		e.button != 0 || r && e.target != t || n(e);
	};
}
function as(e, t, n, r = !0) {
	return (e) => {
		r && e.target != t || n(e);
	};
}
var os = {
	show: !0,
	x: !0,
	y: !0,
	lock: !1,
	move: rs,
	points: {
		one: !1,
		show: Qo,
		size: ts,
		width: 0,
		stroke: es,
		fill: $o
	},
	bind: {
		mousedown: is,
		mouseup: is,
		click: is,
		dblclick: is,
		mousemove: as,
		mouseleave: as,
		mouseenter: as
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
}, ss = {
	show: !0,
	stroke: "rgba(0,0,0,0.07)",
	width: 2
}, cs = Za({}, ss, { filter: Da }), ls = Za({}, cs, { size: 10 }), us = Za({}, ss, { show: !1 }), ds = "12px system-ui, -apple-system, \"Segoe UI\", Roboto, \"Helvetica Neue\", Arial, \"Noto Sans\", sans-serif, \"Apple Color Emoji\", \"Segoe UI Emoji\", \"Segoe UI Symbol\", \"Noto Color Emoji\"", fs = "bold " + ds, ps = 1.5, ms = {
	show: !0,
	scale: "x",
	stroke: li,
	space: 50,
	gap: 5,
	alignTo: 1,
	size: 50,
	labelGap: 0,
	labelSize: 30,
	labelFont: fs,
	side: 2,
	grid: cs,
	ticks: ls,
	border: us,
	font: ds,
	lineGap: ps,
	rotate: 0
}, hs = "Value", gs = "Time", _s = {
	show: !0,
	scale: "x",
	auto: !1,
	sorted: 1,
	min: xa,
	max: -Infinity,
	idxs: []
};
function vs(e, t, n, r, i) {
	return t.map((e) => e == null ? "" : oa(e));
}
function ys(e, t, n, r, i, a, o) {
	let s = [], c = Ia.get(i) || 0;
	n = o ? n : Z(Pa(n, i), c);
	for (let e = n; e <= r; e = Z(e + i, c)) s.push(Object.is(e, -0) ? 0 : e);
	return s;
}
function bs(e, t, n, r, i, a, o) {
	let s = [], c = e.scales[e.axes[t].scale].log;
	i = ha(c, ua((c == 10 ? _a : va)(n))), c == 10 && (i = wo[Ui(i, wo)]);
	let l = n, u = i * c;
	c == 10 && (u = wo[Ui(u, wo)]);
	do
		s.push(l), l += i, c == 10 && !Ia.has(l) && (l = Z(l, Ia.get(i))), l >= u && (i = l, u = i * c, c == 10 && (u = wo[Ui(u, wo)]));
	while (l <= r);
	return s;
}
function xs(e, t, n, r, i, a, o) {
	let s = e.scales[e.axes[t].scale].asinh, c = r > s ? bs(e, t, ma(s, n), r, i) : [s], l = r >= 0 && n <= 0 ? [0] : [];
	return (n < -s ? bs(e, t, ma(s, -r), -n, i) : [s]).reverse().map((e) => -e).concat(l, c);
}
var Ss = /./, Cs = /[12357]/, ws = /[125]/, Ts = /1/, Es = (e, t, n, r) => e.map((e, i) => t == 4 && e == 0 || i % r == 0 && n.test(e.toExponential()[+(e < 0)]) ? e : null);
function Ds(e, t, n, r, i) {
	let a = e.axes[n], o = a.scale, s = e.scales[o], c = e.valToPos, l = a._space, u = c(10, o), d = c(9, o) - u >= l ? Ss : c(7, o) - u >= l ? Cs : c(5, o) - u >= l ? ws : Ts;
	if (d == Ts) {
		let e = la(c(1, o) - u);
		if (e < l) return Es(t.slice().reverse(), s.distr, d, fa(l / e)).reverse();
	}
	return Es(t, s.distr, d, 1);
}
function Os(e, t, n, r, i) {
	let a = e.axes[n], o = a.scale, s = a._space, c = e.valToPos, l = la(c(1, o) - c(2, o));
	return l < s ? Es(t.slice().reverse(), 3, Ss, fa(s / l)).reverse() : t;
}
function ks(e, t, n, r) {
	return r == null ? xi : t == null ? "" : oa(t);
}
var As = {
	show: !0,
	scale: "y",
	stroke: li,
	space: 30,
	gap: 5,
	alignTo: 1,
	size: 50,
	labelGap: 0,
	labelSize: 30,
	labelFont: fs,
	side: 3,
	grid: cs,
	ticks: ls,
	border: us,
	font: ds,
	lineGap: ps,
	rotate: 0
};
function js(e, t) {
	return Z((3 + (e || 1) * 2) * t, 3);
}
function Ms(e, t) {
	let { scale: n, idxs: r } = e.series[0], i = e._data[0], a = e.valToPos(i[r[0]], n, !0), o = la(e.valToPos(i[r[1]], n, !0) - a) / (e.series[t].points.space * J);
	return r[1] - r[0] <= o;
}
var Ns = {
	scale: null,
	auto: !0,
	sorted: 0,
	min: xa,
	max: -Infinity
}, Ps = (e, t, n, r, i) => i, Fs = {
	show: !0,
	auto: !0,
	sorted: 0,
	gaps: Ps,
	alpha: 1,
	facets: [Za({}, Ns, { scale: "x" }), Za({}, Ns, { scale: "y" })]
}, Is = {
	scale: "y",
	auto: !0,
	sorted: 0,
	show: !0,
	spanGaps: !1,
	gaps: Ps,
	alpha: 1,
	points: {
		show: Ms,
		filter: null
	},
	values: null,
	min: xa,
	max: -Infinity,
	idxs: [],
	path: null,
	clip: null
};
function Ls(e, t, n, r, i) {
	return n / 10;
}
var Rs = {
	time: Ir,
	auto: !0,
	distr: 1,
	log: 10,
	asinh: 1,
	min: null,
	max: null,
	dir: 1,
	ori: 0
}, zs = Za({}, Rs, {
	time: !1,
	ori: 1
}), Bs = {};
function Vs(e, t) {
	let n = Bs[e];
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
	}, e != null && (Bs[e] = n)), n;
}
var Hs = 1, Us = 2;
function Ws(e, t, n) {
	let r = e.mode, i = e.series[t], a = r == 2 ? e._data[t] : e._data, o = e.scales, s = e.bbox, c = a[0], l = r == 2 ? a[1] : a[t], u = r == 2 ? o[i.facets[0].scale] : o[e.series[0].scale], d = r == 2 ? o[i.facets[1].scale] : o[i.scale], f = s.left, p = s.top, m = s.width, h = s.height, g = e.valToPosH, _ = e.valToPosV;
	return u.ori == 0 ? n(i, c, l, u, d, g, _, f, p, m, h, $s, tc, rc, ac, sc) : n(i, c, l, u, d, _, g, p, f, h, m, ec, nc, ic, oc, cc);
}
function Gs(e, t) {
	let n = 0, r = 0, i = Y(e.bands, Ba);
	for (let e = 0; e < i.length; e++) {
		let a = i[e];
		a.series[0] == t ? n = a.dir : a.series[1] == t && (a.dir == 1 ? r |= 1 : r |= 2);
	}
	return [n, r == 1 ? -1 : r == 2 ? 1 : r == 3 ? 2 : 0];
}
function Ks(e, t, n, r, i) {
	let a = e.mode, o = e.series[t], s = a == 2 ? o.facets[1].scale : o.scale, c = e.scales[s];
	return i == -1 ? c.min : i == 1 ? c.max : c.distr == 3 ? c.dir == 1 ? c.min : c.max : 0;
}
function qs(e, t, n, r, i, a) {
	return Ws(e, t, (e, t, o, s, c, l, u, d, f, p, m) => {
		let h = e.pxRound, g = s.dir * (s.ori == 0 ? 1 : -1), _ = s.ori == 0 ? tc : nc, v, y;
		g == 1 ? (v = n, y = r) : (v = r, y = n);
		let b = h(l(t[v], s, p, d)), x = h(u(o[v], c, m, f)), S = h(l(t[y], s, p, d)), C = h(u(a == 1 ? c.max : c.min, c, m, f)), w = new Path2D(i);
		return _(w, S, C), _(w, b, C), _(w, b, x), w;
	});
}
function Js(e, t, n, r, i, a) {
	let o = null;
	if (e.length > 0) {
		o = new Path2D();
		let s = t == 0 ? rc : ic, c = n;
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
function Ys(e, t, n) {
	let r = e[e.length - 1];
	r && r[0] == t ? r[1] = n : e.push([t, n]);
}
function Xs(e, t, n, r, i, a, o) {
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
function Zs(e) {
	return e == 0 ? Ea : e == 1 ? da : (t) => Na(t, e);
}
function Qs(e) {
	let t = e == 0 ? $s : ec, n = e == 0 ? (e, t, n, r, i, a) => {
		e.arcTo(t, n, r, i, a);
	} : (e, t, n, r, i, a) => {
		e.arcTo(n, t, i, r, a);
	}, r = e == 0 ? (e, t, n, r, i) => {
		e.rect(t, n, r, i);
	} : (e, t, n, r, i) => {
		e.rect(n, t, i, r);
	};
	return (e, i, a, o, s, c = 0, l = 0) => {
		c == 0 && l == 0 ? r(e, i, a, o, s) : (c = pa(c, o / 2, s / 2), l = pa(l, o / 2, s / 2), t(e, i + c, a), n(e, i + o, a, i + o, a + s, c), n(e, i + o, a + s, i, a + s, l), n(e, i, a + s, i, a, l), n(e, i, a, i + o, a, c), e.closePath());
	};
}
var $s = (e, t, n) => {
	e.moveTo(t, n);
}, ec = (e, t, n) => {
	e.moveTo(n, t);
}, tc = (e, t, n) => {
	e.lineTo(t, n);
}, nc = (e, t, n) => {
	e.lineTo(n, t);
}, rc = Qs(0), ic = Qs(1), ac = (e, t, n, r, i, a) => {
	e.arc(t, n, r, i, a);
}, oc = (e, t, n, r, i, a) => {
	e.arc(n, t, r, i, a);
}, sc = (e, t, n, r, i, a, o) => {
	e.bezierCurveTo(t, n, r, i, a, o);
}, cc = (e, t, n, r, i, a, o) => {
	e.bezierCurveTo(n, t, i, r, o, a);
};
function lc(e) {
	return (e, t, n, r, i) => Ws(e, t, (t, a, o, s, c, l, u, d, f, p, m) => {
		let { pxRound: h, points: g } = t, _, v;
		s.ori == 0 ? (_ = $s, v = ac) : (_ = ec, v = oc);
		let y = Z(g.width * J, 3), b = (g.size - g.width) / 2 * J, x = Z(b * 2, 3), S = new Path2D(), C = new Path2D(), { left: w, top: T, width: E, height: D } = e.bbox;
		rc(C, w - x, T - x, E + x * 2, D + x * 2);
		let O = (e) => {
			if (o[e] != null) {
				let t = h(l(a[e], s, p, d)), n = h(u(o[e], c, m, f));
				_(S, t + b, n), v(S, t, n, b, 0, ca * 2);
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
function uc(e) {
	return (t, n, r, i, a, o) => {
		r != i && (a != r && o != r && e(t, n, r), a != i && o != i && e(t, n, i), e(t, n, o));
	};
}
var dc = uc(tc), fc = uc(nc);
function pc(e) {
	let t = Y(e?.alignGaps, 0);
	return (e, n, r, i) => Ws(e, n, (a, o, s, c, l, u, d, f, p, m, h) => {
		[r, i] = qi(s, r, i);
		let g = a.pxRound, _ = (e) => g(u(e, c, m, f)), v = (e) => g(d(e, l, h, p)), y, b;
		c.ori == 0 ? (y = tc, b = dc) : (y = nc, b = fc);
		let x = c.dir * (c.ori == 0 ? 1 : -1), S = {
			stroke: new Path2D(),
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: Hs
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
		let [T, E] = Gs(e, n);
		if (a.fill != null || T != 0) {
			let t = S.fill = new Path2D(C), s = v(a.fillTo(e, n, a.min, a.max, T)), c = _(o[r]), l = _(o[i]);
			x == -1 && ([l, c] = [c, l]), y(t, l, s), y(t, c, s);
		}
		if (!a.spanGaps) {
			let l = [];
			w && l.push(...Xs(o, s, r, i, x, _, t)), S.gaps = l = a.gaps(e, n, r, i, l), S.clip = Js(l, c.ori, f, p, m, h);
		}
		return E != 0 && (S.band = E == 2 ? [qs(e, n, r, i, C, -1), qs(e, n, r, i, C, 1)] : qs(e, n, r, i, C, E)), S;
	});
}
function mc(e) {
	let t = Y(e.align, 1), n = Y(e.ascDesc, !1), r = Y(e.alignGaps, 0), i = Y(e.extend, !1);
	return (e, a, o, s) => Ws(e, a, (c, l, u, d, f, p, m, h, g, _, v) => {
		[o, s] = qi(u, o, s);
		let y = c.pxRound, { left: b, width: x } = e.bbox, S = (e) => y(p(e, d, _, h)), C = (e) => y(m(e, f, v, g)), w = d.ori == 0 ? tc : nc, T = {
			stroke: new Path2D(),
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: Hs
		}, E = T.stroke, D = d.dir * (d.ori == 0 ? 1 : -1), O = C(u[D == 1 ? o : s]), k = S(l[D == 1 ? o : s]), A = k, j = k;
		i && t == -1 && (j = b, w(E, j, O)), w(E, k, O);
		for (let e = D == 1 ? o : s; e >= o && e <= s; e += D) {
			let n = u[e];
			if (n == null) continue;
			let r = S(l[e]), i = C(n);
			t == 1 ? w(E, r, O) : w(E, A, i), w(E, r, i), O = i, A = r;
		}
		let ee = A;
		i && t == 1 && (ee = b + x, w(E, ee, O));
		let [te, ne] = Gs(e, a);
		if (c.fill != null || te != 0) {
			let t = T.fill = new Path2D(E), n = C(c.fillTo(e, a, c.min, c.max, te));
			w(t, ee, n), w(t, j, n);
		}
		if (!c.spanGaps) {
			let i = [];
			i.push(...Xs(l, u, o, s, D, S, r));
			let f = c.width * J / 2, p = n || t == 1 ? f : -f, m = n || t == -1 ? -f : f;
			i.forEach((e) => {
				e[0] += p, e[1] += m;
			}), T.gaps = i = c.gaps(e, a, o, s, i), T.clip = Js(i, d.ori, h, g, _, v);
		}
		return ne != 0 && (T.band = ne == 2 ? [qs(e, a, o, s, E, -1), qs(e, a, o, s, E, 1)] : qs(e, a, o, s, E, ne)), T;
	});
}
function hc(e, t, n, r, i, a, o = xa) {
	if (e.length > 1) {
		let s = null;
		for (let c = 0, l = Infinity; c < e.length; c++) if (t[c] !== void 0) {
			if (s != null) {
				let t = la(e[c] - e[s]);
				t < l && (l = t, o = la(n(e[c], r, i, a) - n(e[s], r, i, a)));
			}
			s = c;
		}
	}
	return o;
}
function gc(e) {
	e ||= za;
	let t = Y(e.size, [
		.6,
		xa,
		1
	]), n = e.align || 0, r = e.gap || 0, i = e.radius;
	i = i == null ? [0, 0] : typeof i == "number" ? [i, 0] : i;
	let a = X(i), o = 1 - t[0], s = Y(t[1], xa), c = Y(t[2], 1), l = Y(e.disp, za), u = Y(e.each, (e) => {}), { fill: d, stroke: f } = l;
	return (e, t, i, p) => Ws(e, t, (m, h, g, _, v, y, b, x, S, C, w) => {
		let T = m.pxRound, E = n, D = r * J, O = s * J, k = c * J, A, j;
		_.ori == 0 ? [A, j] = a(e, t) : [j, A] = a(e, t);
		let ee = _.dir * (_.ori == 0 ? 1 : -1), te = _.ori == 0 ? rc : ic, ne = _.ori == 0 ? u : (e, t, n, r, i, a, o) => {
			u(e, t, n, i, r, o, a);
		}, re = Y(e.bands, Ba).find((e) => e.series[0] == t), ie = re == null ? 0 : re.dir, ae = m.fillTo(e, t, m.min, m.max, ie), M = T(b(ae, v, w, S)), N, P, oe, se = C, F = T(m.width * J), ce = !1, le = null, ue = null, de = null, fe = null;
		d != null && (F == 0 || f != null) && (ce = !0, le = d.values(e, t, i, p), ue = /* @__PURE__ */ new Map(), new Set(le).forEach((e) => {
			e != null && ue.set(e, new Path2D());
		}), F > 0 && (de = f.values(e, t, i, p), fe = /* @__PURE__ */ new Map(), new Set(de).forEach((e) => {
			e != null && fe.set(e, new Path2D());
		})));
		let { x0: pe, size: me } = l;
		if (pe != null && me != null) {
			E = 1, h = pe.values(e, t, i, p), pe.unit == 2 && (h = h.map((t) => e.posToVal(x + t * C, _.key, !0)));
			let n = me.values(e, t, i, p);
			P = me.unit == 2 ? n[0] * C : y(n[0], _, C, x) - y(0, _, C, x), se = hc(h, g, y, _, C, x, se), oe = se - P + D;
		} else se = hc(h, g, y, _, C, x, se), oe = se * o + D, P = se - oe;
		oe < 1 && (oe = 0), F >= P / 2 && (F = 0), oe < 5 && (T = Ea);
		let he = oe > 0, ge = se - oe - (he ? F : 0);
		P = T(Ca(ge, k, O)), N = (E == 0 ? P / 2 : E == ee ? 0 : P) - E * ee * ((E == 0 ? D / 2 : 0) + (he ? F / 2 : 0));
		let _e = {
			stroke: null,
			fill: null,
			clip: null,
			band: null,
			gaps: null,
			flags: 0
		}, ve = ce ? null : new Path2D(), ye = null;
		if (re != null) ye = e.data[re.series[1]];
		else {
			let { y0: n, y1: r } = l;
			n != null && r != null && (g = r.values(e, t, i, p), ye = n.values(e, t, i, p));
		}
		let be = A * P, xe = j * P;
		for (let n = ee == 1 ? i : p; n >= i && n <= p; n += ee) {
			let r = g[n];
			if (r == null) continue;
			if (ye != null) {
				let e = ye[n] ?? 0;
				if (r - e == 0) continue;
				M = b(e, v, w, S);
			}
			let i = y(_.distr != 2 || l != null ? h[n] : n, _, C, x), a = b(Y(r, ae), v, w, S), o = T(i - N), s = T(ma(a, M)), c = T(pa(a, M)), u = s - c;
			if (r != null) {
				let i = r < 0 ? xe : be, a = r < 0 ? be : xe;
				ce ? (F > 0 && de[n] != null && te(fe.get(de[n]), o, c + ua(F / 2), P, ma(0, u - F), i, a), le[n] != null && te(ue.get(le[n]), o, c + ua(F / 2), P, ma(0, u - F), i, a)) : te(ve, o, c + ua(F / 2), P, ma(0, u - F), i, a), ne(e, t, n, o - F / 2, c, P + F, u);
			}
		}
		return F > 0 ? _e.stroke = ce ? fe : ve : ce || (_e._fill = m.width == 0 ? m._fill : m._stroke ?? m._fill, _e.width = 0), _e.fill = ce ? ue : ve, _e;
	});
}
function _c(e, t) {
	let n = Y(t?.alignGaps, 0);
	return (t, r, i, a) => Ws(t, r, (o, s, c, l, u, d, f, p, m, h, g) => {
		[i, a] = qi(c, i, a);
		let _ = o.pxRound, v = (e) => _(d(e, l, h, p)), y = (e) => _(f(e, u, g, m)), b, x, S;
		l.ori == 0 ? (b = $s, S = tc, x = sc) : (b = ec, S = nc, x = cc);
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
			flags: Hs
		}, k = O.stroke, [A, j] = Gs(t, r);
		if (o.fill != null || A != 0) {
			let e = O.fill = new Path2D(k), n = y(o.fillTo(t, r, o.min, o.max, A));
			S(e, T, n), S(e, w, n);
		}
		if (!o.spanGaps) {
			let e = [];
			e.push(...Xs(s, c, i, a, C, v, n)), O.gaps = e = o.gaps(t, r, i, a, e), O.clip = Js(e, l.ori, p, m, h, g);
		}
		return j != 0 && (O.band = j == 2 ? [qs(t, r, i, a, k, -1), qs(t, r, i, a, k, 1)] : qs(t, r, i, a, k, j)), O;
	});
}
function vc(e) {
	return _c(yc, e);
}
function yc(e, t, n, r, i, a) {
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
var bc = /* @__PURE__ */ new Set();
function xc() {
	for (let e of bc) e.syncRect(!0);
}
Si && (Vi(_i, wi, xc), Vi(vi, wi, xc, !0), Vi(bi, wi, () => {
	Lc.pxRatio = J;
}));
var Sc = pc(), Cc = lc();
function wc(e, t, n, r) {
	return (r ? [e[0], e[1]].concat(e.slice(2)) : [e[0]].concat(e.slice(1))).map((e, r) => Ec(e, r, t, n));
}
function Tc(e, t) {
	return e.map((e, n) => n == 0 ? {} : Za({}, t, e));
}
function Ec(e, t, n, r) {
	return Za({}, t == 0 ? n : r, e);
}
function Dc(e, t, n) {
	return t == null ? Va : [t, n];
}
var Oc = Dc;
function kc(e, t, n) {
	return t == null ? Va : na(t, n, Qi, !0);
}
function Ac(e, t, n, r) {
	return t == null ? Va : Xi(t, n, e.scales[r].log, !1);
}
var jc = Ac;
function Mc(e, t, n, r) {
	return t == null ? Va : Zi(t, n, e.scales[r].log, !1);
}
var Nc = Mc;
function Pc(e, t, n, r, i) {
	let a = ma(Sa(e), Sa(t)), o = t - e, s = Ui(i / r * o, n);
	do {
		let e = n[s], t = r * e / o;
		if (t >= i && a + (e < 5 ? Ia.get(e) : 0) <= 17) return [e, t];
	} while (++s < n.length);
	return [0, 0];
}
function Fc(e) {
	let t, n;
	return e = e.replace(/(\d+)px/, (e, r) => (t = da((n = +r) * J)) + "px"), [
		e,
		t,
		n
	];
}
function Ic(e) {
	e.show && [e.font, e.labelFont].forEach((e) => {
		let t = Z(e[2] * J, 1);
		e[0] = e[0].replace(/[0-9.]+px/, t + "px"), e[1] = t;
	});
}
function Lc(e, t, n) {
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
	let l = r.root = Mi(Lr);
	if (e.id != null && (l.id = e.id), Oi(l, e.class), e.title) {
		let t = Mi(Br, l);
		t.textContent = e.title;
	}
	let u = ji("canvas"), d = r.ctx = u.getContext("2d"), f = Mi(Vr, l);
	Vi("click", f, (e) => {
		e.target === m && (W != en || G != tn) && on.click(r, e);
	}, !0);
	let p = r.under = Mi(Hr, f);
	f.appendChild(u);
	let m = r.over = Mi(Ur, f);
	e = Xa(e);
	let h = +Y(e.pxAlign, 1), g = Zs(h);
	(e.plugins || []).forEach((t) => {
		t.opts && (e = t.opts(r, e) || e);
	});
	let _ = e.ms || .001, v = r.series = i == 1 ? wc(e.series || [], _s, Is, !1) : Tc(e.series || [null], Fs), y = r.axes = wc(e.axes || [], ms, As, !0), b = r.scales = {}, x = r.bands = e.bands || [];
	x.forEach((e) => {
		e.fill = X(e.fill || null), e.dir = Y(e.dir, -1);
	});
	let S = i == 2 ? v[1].facets[0].scale : v[0].scale, C = {
		axes: zt,
		series: Ot
	}, w = (e.drawOrder || ["axes", "series"]).map((e) => C[e]);
	function T(e) {
		let t = e.distr == 3 ? (t) => _a(t > 0 ? t : e.clamp(r, t, e.min, e.max, e.key)) : e.distr == 4 ? (t) => ba(t, e.asinh) : e.distr == 100 ? (t) => e.fwd(t) : (e) => e;
		return (n) => {
			let r = t(n), { _min: i, _max: a } = e, o = a - i;
			return (r - i) / o;
		};
	}
	function E(t) {
		let n = b[t];
		if (n == null) {
			let r = (e.scales || za)[t] || za;
			if (r.from != null) {
				E(r.from);
				let e = Za({}, b[r.from], r, { key: t });
				e.valToPct = T(e), b[t] = e;
			} else {
				n = b[t] = Za({}, t == S ? Rs : zs, r), n.key = t;
				let e = n.time, a = n.range, o = Ha(a);
				if ((t != S || i == 2 && !e) && (o && (a[0] == null || a[1] == null) && (a = {
					min: a[0] == null ? $i : {
						mode: 1,
						hard: a[0],
						soft: a[0]
					},
					max: a[1] == null ? $i : {
						mode: 1,
						hard: a[1],
						soft: a[1]
					}
				}, o = !1), !o && Ka(a))) {
					let e = a;
					a = (t, n, r) => n == null ? Va : na(n, r, e);
				}
				n.range = X(a || (e ? Oc : t == S ? n.distr == 3 ? jc : n.distr == 4 ? Nc : Dc : n.distr == 3 ? Ac : n.distr == 4 ? Mc : kc)), n.auto = X(!o && n.auto), n.clamp = X(n.clamp || Ls), n._min = n._max = null, n.valToPct = T(n);
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
	D.ori == 0 ? (Oi(l, Rr), k = a, A = o) : (Oi(l, zr), k = o, A = a);
	let j = {};
	for (let e in b) {
		let t = b[e];
		(t.min != null || t.max != null) && (j[e] = {
			min: t.min,
			max: t.max
		}, t.min = t.max = null);
	}
	let ee = e.tzDate || ((e) => new Date(da(e / _))), te = e.fmtDate || go, ne = _ == 1 ? Ro(ee) : Vo(ee), re = Uo(ee, Ho(_ == 1 ? Lo : Bo, te)), ie = Jo(ee, Ko(qo, te)), ae = [], M = r.legend = Za({}, Zo, e.legend), N = r.cursor = Za({}, os, { drag: { y: i == 2 } }, e.cursor), P = M.show, oe = N.show, se = M.markers;
	M.idxs = ae, se.width = X(se.width), se.dash = X(se.dash), se.stroke = X(se.stroke), se.fill = X(se.fill);
	let F, ce, le, ue = [], de = [], fe, pe = !1, me = {};
	if (M.live) {
		let e = v[1] ? v[1].values : null;
		pe = e != null, fe = pe ? e(r, 1, 0) : { _: 0 };
		for (let e in fe) me[e] = xi;
	}
	if (P) {
		if (F = ji("table", Xr, l), le = ji("tbody", null, F), M.mount(r, F), pe) {
			ce = ji("thead", null, F, le);
			let e = ji("tr", null, ce);
			for (var he in ji("th", null, e), fe) ji("th", ti, e).textContent = he;
		} else Oi(F, Qr), M.live && Oi(F, Zr);
	}
	let ge = { show: !0 }, _e = { show: !1 };
	function ve(e, t) {
		if (t == 0 && (pe || !M.live || i == 2)) return Va;
		let n = [], a = ji("tr", $r, le, le.childNodes[t]);
		Oi(a, e.class), e.show || Oi(a, Gr);
		let o = ji("th", null, a);
		if (se.show) {
			let e = Mi(ei, o);
			if (t > 0) {
				let n = se.width(r, t);
				n && (e.style.border = n + "px " + se.dash(r, t) + " " + se.stroke(r, t)), e.style.background = se.fill(r, t);
			}
		}
		let s = Mi(ti, o);
		for (var c in e.label instanceof HTMLElement ? s.appendChild(e.label) : s.textContent = e.label, t > 0 && (se.show || (s.style.color = e.width > 0 ? se.stroke(r, t) : se.fill(r, t)), be("click", o, (t) => {
			if (N._lock) return;
			We(t);
			let n = v.indexOf(e);
			if ((t.ctrlKey || t.metaKey) != M.isolate) {
				let e = v.some((e, t) => t > 0 && t != n && e.show);
				v.forEach((t, r) => {
					r > 0 && pn(r, e ? r == n ? ge : _e : ge, !0, Zn.setSeries);
				});
			} else pn(n, { show: !e.show }, !0, Zn.setSeries);
		}, !1), qe && be(mi, o, (t) => {
			N._lock || (We(t), pn(v.indexOf(e), xn, !0, Zn.setSeries));
		}, !1)), fe) {
			let e = ji("td", ni, a);
			e.textContent = "--", n.push(e);
		}
		return [a, n];
	}
	let ye = /* @__PURE__ */ new Map();
	function be(e, t, n, i = !0) {
		let a = ye.get(t) || {}, o = N.bind[e](r, t, n, i);
		o && (Vi(e, t, a[e] = o), ye.set(t, a));
	}
	function xe(e, t, n) {
		let r = ye.get(t) || {};
		for (let n in r) (e == null || n == e) && (Hi(n, t, r[n]), delete r[n]);
		e ?? ye.delete(t);
	}
	let Se = 0, Ce = 0, I = 0, L = 0, R = 0, we = 0, Te = R, z = we, Ee = I, De = L, Oe = 0, ke = 0, Ae = 0, je = 0;
	r.bbox = {};
	let Me = !1, Ne = !1, Pe = !1, Fe = !1, Ie = !1, Le = !1;
	function Re(e, t, n) {
		(n || e != r.width || t != r.height) && ze(e, t), Bt(!1), Pe = !0, Ne = !0, U();
	}
	function ze(e, t) {
		r.width = Se = I = e, r.height = Ce = L = t, R = we = 0, He(), Ue();
		let n = r.bbox;
		Oe = n.left = Na(R * J, .5), ke = n.top = Na(we * J, .5), Ae = n.width = Na(I * J, .5), je = n.height = Na(L * J, .5);
	}
	function Be() {
		let e = !1, t = 0;
		for (; !e;) {
			t++;
			let n = Lt(t), i = Rt(t);
			e = t == 3 || n && i, e || (ze(r.width, r.height), Ne = !0);
		}
	}
	function Ve({ width: e, height: t }) {
		Re(e, t);
	}
	r.setSize = Ve;
	function He() {
		let e = !1, t = !1, n = !1, r = !1;
		y.forEach((i, a) => {
			if (i.show && i._show) {
				let { side: a, _size: o } = i, s = a % 2, c = o + (i.label == null ? 0 : i.labelSize);
				c > 0 && (s ? (I -= c, a == 3 ? (R += c, r = !0) : n = !0) : (L -= c, a == 0 ? (we += c, e = !0) : t = !0));
			}
		}), nt[0] = e, nt[1] = n, nt[2] = t, nt[3] = r, I -= ot[1] + ot[3], R += ot[3], L -= ot[2] + ot[0], we += ot[0];
	}
	function Ue() {
		let e = R + I, t = we + L, n = R, r = we;
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
	if (N.dataIdx == null) {
		let e = N.hover, n = e.skip = new Set(e.skip ?? []);
		n.add(void 0);
		let r = e.prox = X(e.prox), i = e.bias ??= 0;
		N.dataIdx = (e, a, o, s) => {
			if (a == 0) return o;
			let c = o, l = r(e, a, o, s) ?? xa, u = l >= 0 && l < xa, d = D.ori == 0 ? I : L, f = N.left, p = t[0], m = t[a];
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
			} else u && la(f - k(p[o], D, d, 0)) > l && (c = null);
			return c;
		};
	}
	let We = (e) => {
		N.event = e;
	};
	N.idxs = ae, N._lock = !1;
	let Ge = N.points;
	Ge.show = X(Ge.show), Ge.size = X(Ge.size), Ge.stroke = X(Ge.stroke), Ge.width = X(Ge.width), Ge.fill = X(Ge.fill);
	let Ke = r.focus = Za({}, e.focus || { alpha: .3 }, N.focus), qe = Ke.prox >= 0, Je = qe && Ge.one, Ye = [], Xe = [], Ze = [];
	function Qe(e, t) {
		let n = Ge.show(r, t);
		if (n instanceof HTMLElement) return Oi(n, Yr), Oi(n, e.class), Pi(n, -10, -10, I, L), m.insertBefore(n, Ye[t]), n;
	}
	function $e(e, t) {
		if (i == 1 || t > 0) {
			let t = i == 1 && b[e.scale].time, n = e.value;
			e.value = t ? Ga(n) ? Jo(ee, Ko(n, te)) : n || ie : n || ks, e.label = e.label || (t ? gs : hs);
		}
		if (Je || t > 0) {
			e.width = e.width == null ? 1 : e.width, e.paths = e.paths || Sc || Oa, e.fillTo = X(e.fillTo || Ks), e.pxAlign = +Y(e.pxAlign, h), e.pxRound = Zs(e.pxAlign), e.stroke = X(e.stroke || null), e.fill = X(e.fill || null), e._stroke = e._fill = e._paths = e._focus = null;
			let t = js(ma(1, e.width), 1), n = e.points = Za({}, {
				size: t,
				width: ma(1, t * .2),
				stroke: e.stroke,
				space: t * 2,
				paths: Cc,
				_stroke: null,
				_fill: null
			}, e.points);
			n.show = X(n.show), n.filter = X(n.filter), n.fill = X(n.fill), n.stroke = X(n.stroke), n.paths = X(n.paths), n.pxAlign = e.pxAlign;
		}
		if (P) {
			let n = ve(e, t);
			ue.splice(t, 0, n[0]), de.splice(t, 0, n[1]), M.values.push(null);
		}
		if (oe) {
			ae.splice(t, 0, null);
			let n = null;
			Je ? t == 0 && (n = Qe(e, t)) : t > 0 && (n = Qe(e, t)), Ye.splice(t, 0, n), Xe.splice(t, 0, 0), Ze.splice(t, 0, 0);
		}
		Yn("addSeries", t);
	}
	function et(e, t) {
		t ??= v.length, e = i == 1 ? Ec(e, t, _s, Is) : Ec(e, t, {}, Fs), v.splice(t, 0, e), $e(v[t], t);
	}
	r.addSeries = et;
	function tt(e) {
		if (v.splice(e, 1), P) {
			M.values.splice(e, 1), de.splice(e, 1);
			let t = ue.splice(e, 1)[0];
			xe(null, t.firstChild), t.remove();
		}
		oe && (ae.splice(e, 1), Ye.splice(e, 1)[0].remove(), Xe.splice(e, 1), Ze.splice(e, 1)), Yn("delSeries", e);
	}
	r.delSeries = tt;
	let nt = [
		!1,
		!1,
		!1,
		!1
	];
	function rt(e, t) {
		if (e._show = e.show, e.show) {
			let n = e.side % 2, i = b[e.scale];
			i ??= (e.scale = n ? v[1].scale : S, b[e.scale]);
			let a = i.time;
			e.size = X(e.size), e.space = X(e.space), e.rotate = X(e.rotate), Ha(e.incrs) && e.incrs.forEach((e) => {
				!Ia.has(e) && Ia.set(e, La(e));
			}), e.incrs = X(e.incrs || (i.distr == 2 ? Co : a ? _ == 1 ? Io : zo : wo)), e.splits = X(e.splits || (a && i.distr == 1 ? ne : i.distr == 3 ? bs : i.distr == 4 ? xs : ys)), e.stroke = X(e.stroke), e.grid.stroke = X(e.grid.stroke), e.ticks.stroke = X(e.ticks.stroke), e.border.stroke = X(e.border.stroke);
			let o = e.values;
			e.values = Ha(o) && !Ha(o[0]) ? X(o) : a ? Ha(o) ? Uo(ee, Ho(o, te)) : Ga(o) ? Wo(ee, o) : o || re : o || vs, e.filter = X(e.filter || (i.distr >= 3 && i.log == 10 ? Ds : i.distr == 3 && i.log == 2 ? Os : Da)), e.font = Fc(e.font), e.labelFont = Fc(e.labelFont), e._size = e.size(r, null, t, 0), e._space = e._rotate = e._incrs = e._found = e._splits = e._values = null, e._size > 0 && (nt[t] = !0, e._el = Mi(Wr, f));
		}
	}
	function it(e, t, n, r) {
		let [i, a, o, s] = n, c = t % 2, l = 0;
		return c == 0 && (s || a) && (l = t == 0 && !i || t == 2 && !o ? da(ms.size / 3) : 0), c == 1 && (i || o) && (l = t == 1 && !a || t == 3 && !s ? da(As.size / 2) : 0), l;
	}
	let at = r.padding = (e.padding || [
		it,
		it,
		it,
		it
	]).map((e) => X(Y(e, it))), ot = r._padding = at.map((e, t) => e(r, t, nt, 0)), B, st = null, ct = null, lt = i == 1 ? v[0].idxs : null, ut = null, dt = !1;
	function ft(e, n) {
		if (t = e ?? [], r.data = r._data = t, i == 2) {
			B = 0;
			for (let e = 1; e < v.length; e++) B += t[e][0].length;
		} else {
			t.length == 0 && (r.data = r._data = t = [[]]), ut = t[0], B = ut.length;
			let e = t;
			if (O == 2) {
				e = t.slice();
				let n = e[0] = Array(B);
				for (let e = 0; e < B; e++) n[e] = e;
			}
			r._data = t = e;
		}
		if (Bt(!0), Yn("setData"), O == 2 && (Pe = !0), n !== !1) {
			let e = D;
			e.auto(r, dt) ? pt() : fn(S, e.min, e.max), Fe ||= N.left >= 0, Le = !0, U();
		}
	}
	r.setData = ft;
	function pt() {
		dt = !0;
		let e, n;
		i == 1 && (B > 0 ? (st = lt[0] = 0, ct = lt[1] = B - 1, e = t[0][st], n = t[0][ct], O == 2 ? (e = st, n = ct) : e == n && (O == 3 ? [e, n] = Xi(e, e, D.log, !1) : O == 4 ? [e, n] = Zi(e, e, D.log, !1) : D.time ? n = e + da(86400 / _) : [e, n] = na(e, n, Qi, !0))) : (st = lt[0] = e = null, ct = lt[1] = n = null)), fn(S, e, n);
	}
	let mt, ht, gt, _t, vt, yt, bt, V, xt, H;
	function St(e, t, n, r, i, a) {
		e ??= ui, n ??= Ba, r ??= "butt", i ??= ui, a ??= "round", e != mt && (d.strokeStyle = mt = e), i != ht && (d.fillStyle = ht = i), t != gt && (d.lineWidth = gt = t), a != vt && (d.lineJoin = vt = a), r != yt && (d.lineCap = yt = r), n != _t && d.setLineDash(_t = n);
	}
	function Ct(e, t, n, r) {
		t != ht && (d.fillStyle = ht = t), e != bt && (d.font = bt = e), n != V && (d.textAlign = V = n), r != xt && (d.textBaseline = xt = r);
	}
	function wt(e, t, n, i, a = 0) {
		if (i.length > 0 && e.auto(r, dt) && (t == null || t.min == null)) {
			let t = Y(st, 0), r = Y(ct, i.length - 1), o = n.min == null ? Yi(i, t, r, a, e.distr == 3) : [n.min, n.max];
			e.min = pa(e.min, n.min = o[0]), e.max = ma(e.max, n.max = o[1]);
		}
	}
	let Tt = {
		min: null,
		max: null
	};
	function Et() {
		for (let e in b) {
			let t = b[e];
			j[e] == null && (t.min == null || j[S] != null && t.auto(r, dt)) && (j[e] = Tt);
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
				let a = e[t] = Xa(b[t], qa);
				if (n.min != null) Za(a, n);
				else if (t != S || i == 2) {
					if (B == 0 && a.from == null) {
						let e = a.range(r, null, null, t);
						a.min = e[0], a.max = e[1];
					} else a.min = xa, a.max = -Infinity;
				}
			}
		}
		if (B > 0) {
			v.forEach((n, a) => {
				if (i == 1) {
					let i = n.scale, o = j[i];
					if (o == null) return;
					let s = e[i];
					if (a == 0) {
						let e = s.range(r, s.min, s.max, i);
						s.min = e[0], s.max = e[1], st = Ui(s.min, t[0]), ct = Ui(s.max, t[0]), ct - st > 1 && (t[0][st] < s.min && st++, t[0][ct] > s.max && ct--), n.min = ut[st], n.max = ut[ct];
					} else n.show && n.auto && wt(s, o, n, t[a], n.sorted);
					n.idxs[0] = st, n.idxs[1] = ct;
				} else if (a > 0 && n.show && n.auto) {
					let [r, i] = n.facets, o = r.scale, s = i.scale, [c, l] = t[a], u = e[o], d = e[s];
					u != null && wt(u, j[o], r, c, r.sorted), d != null && wt(d, j[s], i, l, i.sorted), n.min = i.min, n.max = i.max;
				}
			});
			for (let t in e) {
				let n = e[t], i = j[t];
				if (n.from == null && (i == null || i.min == null)) {
					let e = n.range(r, n.min == xa ? null : n.min, n.max == -Infinity ? null : n.max, t);
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
				i._min = e == 3 ? _a(i.min) : e == 4 ? ba(i.min, i.asinh) : e == 100 ? i.fwd(i.min) : i.min, i._max = e == 3 ? _a(i.max) : e == 4 ? ba(i.max, i.asinh) : e == 100 ? i.fwd(i.max) : i.max, n[t] = a = !0;
			}
		}
		if (a) {
			v.forEach((e, t) => {
				i == 2 ? t > 0 && n.y && (e._paths = null) : n[e.scale] && (e._paths = null);
			});
			for (let e in n) Pe = !0, Yn("setScale", e);
			oe && N.left >= 0 && (Fe = Le = !0);
		}
		for (let e in j) j[e] = null;
	}
	function Dt(e) {
		let t = Ca(st - 1, 0, B - 1), n = Ca(ct + 1, 0, B - 1);
		for (; e[t] == null && t > 0;) t--;
		for (; e[n] == null && n < B - 1;) n++;
		return [t, n];
	}
	function Ot() {
		if (B > 0) {
			let e = v.some((e) => e._focus) && H != Ke.alpha;
			e && (d.globalAlpha = H = Ke.alpha), v.forEach((e, n) => {
				if (n > 0 && e.show && (kt(n, !1), kt(n, !0), e._paths == null)) {
					let a = H;
					H != e.alpha && (d.globalAlpha = H = e.alpha);
					let o = i == 2 ? [0, t[n][0].length - 1] : Dt(t[n]);
					e._paths = e.paths(r, n, o[0], o[1]), H != a && (d.globalAlpha = H = a);
				}
			}), v.forEach((e, t) => {
				if (t > 0 && e.show) {
					let n = H;
					H != e.alpha && (d.globalAlpha = H = e.alpha), e._paths != null && At(t, !1);
					{
						let n = e._paths == null ? null : e._paths.gaps, i = e.points.show(r, t, st, ct, n), a = e.points.filter(r, t, i, n);
						(i || a) && (e.points._paths = e.points.paths(r, t, st, ct, a), At(t, !0));
					}
					H != n && (d.globalAlpha = H = n), Yn("drawSeries", t);
				}
			}), e && (d.globalAlpha = H = 1);
		}
	}
	function kt(e, t) {
		let n = t ? v[e].points : v[e];
		n._stroke = n.stroke(r, e), n._fill = n.fill(r, e);
	}
	function At(e, t) {
		let n = t ? v[e].points : v[e], { stroke: r, fill: i, clip: a, flags: o, _stroke: s = n._stroke, _fill: c = n._fill, _width: l = n.width } = n._paths;
		l = Z(l * J, 3);
		let u = null, f = l % 2 / 2;
		t && c == null && (c = l > 0 ? "#fff" : s);
		let p = n.pxAlign == 1 && f > 0;
		if (p && d.translate(f, f), !t) {
			let e = Oe - l / 2, t = ke - l / 2, n = Ae + l, r = je + l;
			u = new Path2D(), u.rect(e, t, n, r);
		}
		t ? Mt(s, l, n.dash, n.cap, c, r, i, o, a) : jt(e, s, l, n.dash, n.cap, c, r, i, o, u, a), p && d.translate(-f, -f);
	}
	function jt(e, n, i, a, o, s, c, l, u, d, f) {
		let p = !1;
		u != 0 && x.forEach((m, h) => {
			if (m.series[0] == e) {
				let e = v[m.series[1]], g = t[m.series[1]], _ = (e._paths || za).band;
				Ha(_) && (_ = m.dir == 1 ? _[0] : _[1]);
				let y, b = null;
				e.show && _ && ra(g, st, ct) ? (b = m.fill(r, h) || s, y = e._paths.clip) : _ = null, Mt(n, i, a, o, b, c, l, u, d, f, y, _), p = !0;
			}
		}), p || Mt(n, i, a, o, s, c, l, u, d, f);
	}
	function Mt(e, t, n, r, i, a, o, s, c, l, u, f) {
		St(e, t, n, r, i), (c || l || f) && (d.save(), c && d.clip(c), l && d.clip(l)), f ? (s & 3) == 3 ? (d.clip(f), u && d.clip(u), Pt(i, o), Nt(e, a, t)) : s & Us ? (Pt(i, o), d.clip(f), Nt(e, a, t)) : s & Hs && (d.save(), d.clip(f), u && d.clip(u), Pt(i, o), d.restore(), Nt(e, a, t)) : (Pt(i, o), Nt(e, a, t)), (c || l || f) && d.restore();
	}
	function Nt(e, t, n) {
		n > 0 && (t instanceof Map ? t.forEach((e, t) => {
			d.strokeStyle = mt = t, d.stroke(e);
		}) : t != null && e && d.stroke(t));
	}
	function Pt(e, t) {
		t instanceof Map ? t.forEach((e, t) => {
			d.fillStyle = ht = t, d.fill(e);
		}) : t != null && e && d.fill(t);
	}
	function Ft(e, t, n, i) {
		let a = y[e], o;
		if (i <= 0) o = [0, 0];
		else {
			let s = a._space = a.space(r, e, t, n, i);
			o = Pc(t, n, a._incrs = a.incrs(r, e, t, n, i, s), i, s);
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
			let o = n.side, s = o % 2, { min: c, max: l } = a, [u, d] = Ft(i, c, l, s == 0 ? I : L);
			if (d == 0) return;
			let f = a.distr == 2, p = n._splits = n.splits(r, i, c, l, u, d, f), m = a.distr == 2 ? p.map((e) => ut[e]) : p, h = a.distr == 2 ? ut[p[1]] - ut[p[0]] : u, g = n._values = n.values(r, n.filter(r, m, i, d, h), i, d, h);
			n._rotate = o == 2 ? n.rotate(r, g, i, d) : 0;
			let _ = n._size;
			n._size = fa(n.size(r, g, i, e)), _ != null && n._size != _ && (t = !1);
		}), t;
	}
	function Rt(e) {
		let t = !0;
		return at.forEach((n, i) => {
			let a = n(r, i, nt, e);
			a != ot[i] && (t = !1), ot[i] = a;
		}), t;
	}
	function zt() {
		for (let e = 0; e < y.length; e++) {
			let t = y[e];
			if (!t.show || !t._show) continue;
			let n = t.side, i = n % 2, a, o, c = t.stroke(r, e), l = n == 0 || n == 3 ? -1 : 1, [u, f] = t._found;
			if (t.label != null) {
				let s = t.labelGap * l, p = da((t._lpos + s) * J);
				Ct(t.labelFont[0], c, "center", n == 2 ? ai : oi), d.save(), i == 1 ? (a = o = 0, d.translate(p, da(ke + je / 2)), d.rotate((n == 3 ? -ca : ca) / 2)) : (a = da(Oe + Ae / 2), o = p);
				let m = wa(t.label) ? t.label(r, e, u, f) : t.label;
				d.fillText(m, a, o), d.restore();
			}
			if (f == 0) continue;
			let p = b[t.scale], m = i == 0 ? Ae : je, h = i == 0 ? Oe : ke, _ = t._splits, v = p.distr == 2 ? _.map((e) => ut[e]) : _, x = p.distr == 2 ? ut[_[1]] - ut[_[0]] : u, S = t.ticks, C = t.border, w = S.show ? S.size : 0, T = da(w * J), E = da((t.alignTo == 2 ? t._size - w - t.gap : t.gap) * J), D = t._rotate * -ca / 180, O = g(t._pos * J), k = O + (T + E) * l;
			o = i == 0 ? k : 0, a = i == 1 ? k : 0;
			let A = t.font[0];
			Ct(A, c, t.align == 1 ? si : t.align == 2 ? ci : D > 0 ? si : D < 0 ? ci : i == 0 ? "center" : n == 3 ? ci : si, D || i == 1 ? "middle" : n == 2 ? ai : oi);
			let j = t.font[1] * t.lineGap, ee = _.map((e) => g(s(e, p, m, h))), te = t._values;
			for (let e = 0; e < te.length; e++) {
				let t = te[e];
				if (t != null) {
					i == 0 ? a = ee[e] : o = ee[e], t = "" + t;
					let n = t.indexOf("\n") == -1 ? [t] : t.split(/\n/gm);
					for (let e = 0; e < n.length; e++) {
						let t = n[e];
						D ? (d.save(), d.translate(a, o + e * j), d.rotate(D), d.fillText(t, 0, 0), d.restore()) : d.fillText(t, a, o + e * j);
					}
				}
			}
			S.show && It(ee, S.filter(r, v, e, f, x), i, n, O, T, Z(S.width * J, 3), S.stroke(r, e), S.dash, S.cap);
			let ne = t.grid;
			ne.show && It(ee, ne.filter(r, v, e, f, x), i, i == 0 ? 2 : 1, i == 0 ? ke : Oe, i == 0 ? je : Ae, Z(ne.width * J, 3), ne.stroke(r, e), ne.dash, ne.cap), C.show && It([O], [1], +(i == 0), i == 0 ? 1 : 2, i == 1 ? ke : Oe, i == 1 ? je : Ae, Z(C.width * J, 3), C.stroke(r, e), C.dash, C.cap);
		}
		Yn("drawAxes");
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
		for (let e = 0; e < Ut.length; e++) Yn(...Ut[e]);
		Ut.length = 0;
	}
	function U() {
		Vt ||= (ro(Kt), !0);
	}
	function Gt(e, t = !1) {
		Vt = !0, Ht = t, e(r), Kt(), t && Ut.length > 0 && queueMicrotask(Wt);
	}
	r.batch = Gt;
	function Kt() {
		if (Me &&= (Et(), !1), Pe &&= (Be(), !1), Ne) {
			if (Ai(p, si, R), Ai(p, ai, we), Ai(p, ri, I), Ai(p, ii, L), Ai(m, si, R), Ai(m, ai, we), Ai(m, ri, I), Ai(m, ii, L), Ai(f, ri, Se), Ai(f, ii, Ce), u.width = da(Se * J), u.height = da(Ce * J), y.forEach(({ _el: e, _show: t, _size: n, _pos: r, side: i }) => {
				if (e != null) {
					if (t) {
						let t = i === 3 || i === 0 ? n : 0, a = i % 2 == 1;
						Ai(e, a ? "left" : "top", r - t), Ai(e, a ? "width" : "height", n), Ai(e, a ? "top" : "left", a ? we : R), Ai(e, a ? "height" : "width", a ? L : I), ki(e, Gr);
					} else Oi(e, Gr);
				}
			}), mt = ht = gt = vt = yt = bt = V = xt = _t = null, H = 1, Pn(!0), R != Te || we != z || I != Ee || L != De) {
				Bt(!1);
				let e = I / Ee, t = L / De;
				if (oe && !Fe && N.left >= 0) {
					N.left *= e, N.top *= t, Xt && Pi(Xt, da(N.left), 0, I, L), Zt && Pi(Zt, 0, da(N.top), I, L);
					for (let n = 0; n < Ye.length; n++) {
						let r = Ye[n];
						r != null && (Xe[n] *= e, Ze[n] *= t, Pi(r, fa(Xe[n]), fa(Ze[n]), I, L));
					}
				}
				if (K.show && !Ie && K.left >= 0 && K.width > 0) {
					K.left *= e, K.width *= e, K.top *= t, K.height *= t;
					for (let e in Ln) Ai(ln, e, K[e]);
				}
				Te = R, z = we, Ee = I, De = L;
			}
			Yn("setSize"), Ne = !1;
		}
		Se > 0 && Ce > 0 && (d.clearRect(0, 0, u.width, u.height), Yn("drawClear"), w.forEach((e) => e()), Yn("draw")), K.show && Ie && (un(K), Ie = !1), oe && Fe && (Mn(null, !0, !1), Fe = !1), M.show && M.live && Le && (An(), Le = !1), c || (c = !0, r.status = 1, Yn("ready")), dt = !1, Vt = !1;
	}
	r.redraw = (e, t) => {
		Pe = t || !1, e === !1 ? U() : fn(S, D.min, D.max);
	};
	function qt(e, n) {
		let i = b[e];
		if (i.from == null) {
			if (B == 0) {
				let t = i.range(r, n.min, n.max, e);
				n.min = t[0], n.max = t[1];
			}
			if (n.min > n.max) {
				let e = n.min;
				n.min = n.max, n.max = e;
			}
			if (B > 1 && n.min != null && n.max != null && n.max - n.min < 1e-16) return;
			e == S && i.distr == 2 && B > 0 && (n.min = Ui(n.min, t[0]), n.max = Ui(n.max, t[0]), n.min == n.max && n.max++), j[e] = n, Me = !0, U();
		}
	}
	r.setScale = qt;
	let Jt, Yt, Xt, Zt, Qt, $t, en, tn, nn, rn, W, G, an = !1, on = N.drag, sn = on.x, cn = on.y;
	oe && (N.x && (Jt = Mi(qr, m)), N.y && (Yt = Mi(Jr, m)), D.ori == 0 ? (Xt = Jt, Zt = Yt) : (Xt = Yt, Zt = Jt), W = N.left, G = N.top);
	let K = r.select = Za({
		show: !0,
		over: !0,
		left: 0,
		width: 0,
		top: 0,
		height: 0
	}, e.select), ln = K.show ? Mi(Kr, K.over ? m : p) : null;
	function un(e, t) {
		if (K.show) {
			for (let t in e) K[t] = e[t], t in Ln && Ai(ln, t, e[t]);
			t !== !1 && Yn("setSelect");
		}
	}
	r.setSelect = un;
	function dn(e) {
		if (v[e].show) P && ki(ue[e], Gr);
		else if (P && Oi(ue[e], Gr), oe) {
			let t = Je ? Ye[0] : Ye[e];
			t != null && Pi(t, -10, -10, I, L);
		}
	}
	function fn(e, t, n) {
		qt(e, {
			min: t,
			max: n
		});
	}
	function pn(e, t, n, a) {
		t.focus != null && Sn(e), t.show != null && v.forEach((n, r) => {
			r > 0 && (e == r || e == null) && (n.show = t.show, dn(r), i == 2 ? (fn(n.facets[0].scale, null, null), fn(n.facets[1].scale, null, null)) : fn(n.scale, null, null), U());
		}), n !== !1 && Yn("setSeries", e, t), a && er("setSeries", r, e, t);
	}
	r.setSeries = pn;
	function mn(e, t) {
		Za(x[e], t);
	}
	function hn(e, t) {
		e.fill = X(e.fill || null), e.dir = Y(e.dir, -1), t ??= x.length, x.splice(t, 0, e);
	}
	function gn(e) {
		e == null ? x.length = 0 : x.splice(e, 1);
	}
	r.addBand = hn, r.setBand = mn, r.delBand = gn;
	function _n(e, t) {
		v[e].alpha = t, oe && Ye[e] != null && (Ye[e].style.opacity = t), P && ue[e] && (ue[e].style.opacity = t);
	}
	let vn, yn, bn, xn = { focus: !0 };
	function Sn(e) {
		if (e != bn) {
			let t = e == null, n = Ke.alpha != 1;
			v.forEach((r, a) => {
				if (i == 1 || a > 0) {
					let i = t || a == 0 || a == e;
					r._focus = t ? null : i, n && _n(a, i ? 1 : Ke.alpha);
				}
			}), bn = e, n && U();
		}
	}
	P && qe && be(hi, F, (e) => {
		N._lock || (We(e), bn != null && pn(null, xn, !0, Zn.setSeries));
	});
	function Cn(e, t, n) {
		let r = b[t];
		n && (e = e / J - (r.ori == 1 ? we : R));
		let i = I;
		r.ori == 1 && (i = L, e = i - e), r.dir == -1 && (e = i - e);
		let a = r._min, o = r._max, s = e / i, c = a + (o - a) * s, l = r.distr;
		return l == 3 ? ha(10, c) : l == 4 ? ya(c, r.asinh) : l == 100 ? r.bwd(c) : c;
	}
	function wn(e, n) {
		return Ui(Cn(e, S, n), t[0], st, ct);
	}
	r.valToIdx = (e) => Ui(e, t[0]), r.posToIdx = wn, r.posToVal = Cn, r.valToPos = (e, t, n) => b[t].ori == 0 ? a(e, b[t], n ? Ae : I, n ? Oe : 0) : o(e, b[t], n ? je : L, n ? ke : 0), r.setCursor = (e, t, n) => {
		W = e.left, G = e.top, Mn(null, t, n);
	};
	function Tn(e, t) {
		Ai(ln, si, K.left = e), Ai(ln, ri, K.width = t);
	}
	function En(e, t) {
		Ai(ln, ai, K.top = e), Ai(ln, ii, K.height = t);
	}
	let Dn = D.ori == 0 ? Tn : En, On = D.ori == 1 ? Tn : En;
	function kn() {
		if (P && M.live) for (let e = +(i == 2); e < v.length; e++) {
			if (e == 0 && pe) continue;
			let t = M.values[e], n = 0;
			for (let r in t) de[e][n++].firstChild.nodeValue = t[r];
		}
	}
	function An(e, t) {
		if (e != null && (e.idxs ? e.idxs.forEach((e, t) => {
			ae[t] = e;
		}) : Wa(e.idx) || ae.fill(e.idx), M.idx = ae[0]), P && M.live) {
			for (let e = 0; e < v.length; e++) (e > 0 || i == 1 && !pe) && jn(e, ae[e]);
			kn();
		}
		Le = !1, t !== !1 && Yn("setLegend");
	}
	r.setLegend = An;
	function jn(e, n) {
		let i = v[e], a = e == 0 && O == 2 ? ut : t[e], o;
		pe ? o = i.values(r, e, n) ?? me : (o = i.value(r, n == null ? null : a[n], e, n), o = o == null ? me : { _: o }), M.values[e] = o;
	}
	function Mn(e, n, a) {
		nn = W, rn = G, [W, G] = N.move(r, W, G), N.left = W, N.top = G, oe && (Xt && Pi(Xt, da(W), 0, I, L), Zt && Pi(Zt, 0, da(G), I, L));
		let o, s = st > ct;
		vn = xa, yn = null;
		let c = D.ori == 0 ? I : L, l = D.ori == 1 ? I : L;
		if (W < 0 || B == 0 || s) {
			o = N.idx = null;
			for (let e = 0; e < v.length; e++) {
				let t = Ye[e];
				t != null && Pi(t, -10, -10, I, L);
			}
			qe && pn(null, xn, !0, e == null && Zn.setSeries), M.live && (ae.fill(o), Le = !0);
		} else {
			let e, n, a;
			i == 1 && (e = D.ori == 0 ? W : G, n = Cn(e, S), o = N.idx = Ui(n, t[0], st, ct), a = k(t[0][o], D, c, 0));
			let s = -10, u = -10, d = 0, f = 0, p = !0, m = "", h = "";
			for (let e = +(i == 2); e < v.length; e++) {
				let g = v[e], _ = ae[e], y = _ == null ? null : i == 1 ? t[e][_] : t[e][1][_], x = N.dataIdx(r, e, o, n), S = x == null ? null : i == 1 ? t[e][x] : t[e][1][x];
				if (Le = Le || S != y || x != _, ae[e] = x, e > 0 && g.show) {
					let n = x == null ? -10 : x == o ? a : k(i == 1 ? t[0][x] : t[e][0][x], D, c, 0), _ = S == null ? -10 : A(S, i == 1 ? b[g.scale] : b[g.facets[1].scale], l, 0);
					if (qe && S != null) {
						let t = D.ori == 1 ? W : G, n = la(Ke.dist(r, e, x, _, t));
						if (n < vn) {
							let r = Ke.bias;
							if (r != 0) {
								let i = Cn(t, g.scale), a = S >= 0 ? 1 : -1, o = i >= 0 ? 1 : -1;
								o == a && (o == 1 ? r == 1 ? S >= i : S <= i : r == 1 ? S <= i : S >= i) && (vn = n, yn = e);
							} else vn = n, yn = e;
						}
					}
					if (Le || Je) {
						let t, i;
						D.ori == 0 ? (t = n, i = _) : (t = _, i = n);
						let a, o, c, l, g, v, y = !0, b = Ge.bbox;
						if (b != null) {
							y = !1;
							let t = b(r, e);
							c = t.left, l = t.top, a = t.width, o = t.height;
						} else c = t, l = i, a = o = Ge.size(r, e);
						if (v = Ge.fill(r, e), g = Ge.stroke(r, e), Je) e == yn && vn <= Ke.prox && (s = c, u = l, d = a, f = o, p = y, m = v, h = g);
						else {
							let t = Ye[e];
							t != null && (Xe[e] = c, Ze[e] = l, Ri(t, a, o, y), Ii(t, v, g), Pi(t, fa(c), fa(l), I, L));
						}
					}
				}
			}
			if (Je) {
				let e = Ke.prox;
				if (Le || (bn == null ? vn <= e : vn > e || yn != bn)) {
					let e = Ye[0];
					e != null && (Xe[0] = s, Ze[0] = u, Ri(e, d, f, p), Ii(e, m, h), Pi(e, fa(s), fa(u), I, L));
				}
			}
		}
		if (K.show && an) {
			if (e != null) {
				let [t, n] = Zn.scales, [r, i] = Zn.match, [a, o] = e.cursor.sync.scales, s = e.cursor.drag;
				if (sn = s._x, cn = s._y, sn || cn) {
					let { left: s, top: u, width: d, height: f } = e.select, p = e.scales[a].ori, m = e.posToVal, h, g, _, v, y, x = t != null && r(t, a), S = n != null && i(n, o);
					x && sn ? (p == 0 ? (h = s, g = d) : (h = u, g = f), _ = b[t], v = k(m(h, a), _, c, 0), y = k(m(h + g, a), _, c, 0), Dn(pa(v, y), la(y - v))) : Dn(0, c), S && cn ? (p == 1 ? (h = s, g = d) : (h = u, g = f), _ = b[n], v = A(m(h, o), _, l, 0), y = A(m(h + g, o), _, l, 0), On(pa(v, y), la(y - v))) : On(0, l);
				} else Rn();
			} else {
				let e = la(nn - Qt), t = la(rn - $t);
				if (D.ori == 1) {
					let n = e;
					e = t, t = n;
				}
				sn = on.x && e >= on.dist, cn = on.y && t >= on.dist;
				let n = on.uni;
				n == null ? on.x && on.y && (sn || cn) && (sn = cn = !0) : sn && cn && (sn = e >= n, cn = t >= n, !sn && !cn && (t > e ? cn = !0 : sn = !0));
				let r, i;
				sn && (D.ori == 0 ? (r = en, i = W) : (r = tn, i = G), Dn(pa(r, i), la(i - r)), cn || On(0, l)), cn && (D.ori == 1 ? (r = en, i = W) : (r = tn, i = G), On(pa(r, i), la(i - r)), sn || Dn(0, c)), !sn && !cn && (Dn(0, 0), On(0, 0));
			}
		}
		if (on._x = sn, on._y = cn, e == null) {
			if (a) {
				if (Qn != null) {
					let [e, t] = Zn.scales;
					Zn.values[0] = e == null ? null : Cn(D.ori == 0 ? W : G, e), Zn.values[1] = t == null ? null : Cn(D.ori == 1 ? W : G, t);
				}
				er(di, r, W, G, I, L, o);
			}
			if (qe) {
				let e = a && Zn.setSeries, t = Ke.prox;
				bn == null ? vn <= t && pn(yn, xn, !0, e) : vn > t ? pn(null, xn, !0, e) : yn != bn && pn(yn, xn, !0, e);
			}
		}
		Le && (M.idx = o, An()), n !== !1 && Yn("setCursor");
	}
	let Nn = null;
	Object.defineProperty(r, "rect", { get() {
		return Nn ?? Pn(!1), Nn;
	} });
	function Pn(e = !1) {
		e ? Nn = null : (Nn = m.getBoundingClientRect(), Yn("syncRect", Nn));
	}
	function Fn(e, t, n, r, i, a, o) {
		N._lock || an && e != null && e.movementX == 0 && e.movementY == 0 || (In(e, t, n, r, i, a, o, !1, e != null), e == null ? Mn(t, !0, !1) : Mn(null, !0, !0));
	}
	function In(e, t, n, i, a, o, c, l, u) {
		if (Nn ?? Pn(!1), We(e), e != null) n = e.clientX - Nn.left, i = e.clientY - Nn.top;
		else {
			if (n < 0 || i < 0) {
				W = -10, G = -10;
				return;
			}
			let [e, r] = Zn.scales, c = t.cursor.sync, [l, u] = c.values, [d, f] = c.scales, [p, m] = Zn.match, h = t.axes[0].side % 2 == 1, g = D.ori == 0 ? I : L, _ = D.ori == 1 ? I : L, v = h ? o : a, y = h ? a : o, x = h ? i : n, S = h ? n : i;
			if (n = d == null ? x / v * g : p(e, d) ? s(l, b[e], g, 0) : -10, i = f == null ? S / y * _ : m(r, f) ? s(u, b[r], _, 0) : -10, D.ori == 1) {
				let e = n;
				n = i, i = e;
			}
		}
		u && (t == null || t.cursor.event.type == di) && ((n <= 1 || n >= I - 1) && (n = Na(n, I)), (i <= 1 || i >= L - 1) && (i = Na(i, L))), l ? (Qt = n, $t = i, [en, tn] = N.move(r, n, i)) : (W = n, G = i);
	}
	let Ln = {
		width: 0,
		height: 0,
		left: 0,
		top: 0
	};
	function Rn() {
		un(Ln, !1);
	}
	let zn, Bn, Vn, Hn;
	function Un(e, t, n, i, a, o, s) {
		an = !0, sn = cn = on._x = on._y = !1, In(e, t, n, i, a, o, s, !0, !1), e != null && (be(pi, Ci, Wn, !1), er(fi, r, en, tn, I, L, null));
		let { left: c, top: l, width: u, height: d } = K;
		zn = c, Bn = l, Vn = u, Hn = d;
	}
	function Wn(e, t, n, i, a, o, s) {
		an = on._x = on._y = !1, In(e, t, n, i, a, o, s, !1, !0);
		let { left: c, top: l, width: u, height: d } = K, f = u > 0 || d > 0, p = zn != c || Bn != l || Vn != u || Hn != d;
		if (f && p && un(K), on.setScale && f && p) {
			let e = c, t = u, n = l, r = d;
			if (D.ori == 1 && (e = l, t = d, n = c, r = u), sn && fn(S, Cn(e, S), Cn(e + t, S)), cn) for (let e in b) {
				let t = b[e];
				e != S && t.from == null && t.min != xa && fn(e, Cn(n + r, e), Cn(n, e));
			}
			Rn();
		} else N.lock && (N._lock = !N._lock, Mn(t, !0, e != null));
		e != null && (xe(pi, Ci), er(pi, r, W, G, I, L, null));
	}
	function q(e, t, n, r, i, a, o) {
		if (N._lock) return;
		We(e);
		let s = an;
		if (an) {
			let e = !0, t = !0, n, r;
			D.ori == 0 ? (n = sn, r = cn) : (n = cn, r = sn), n && r && (e = W <= 10 || W >= I - 10, t = G <= 10 || G >= L - 10), n && e && (W = W < en ? 0 : I), r && t && (G = G < tn ? 0 : L), Mn(null, !0, !0), an = !1;
		}
		W = -10, G = -10, ae.fill(null), Mn(null, !0, !0), s && (an = s);
	}
	function Gn(e, t, n, i, a, o, s) {
		N._lock || (We(e), pt(), Rn(), e != null && er(gi, r, W, G, I, L, null));
	}
	function Kn() {
		y.forEach(Ic), Re(r.width, r.height, !0);
	}
	Vi(bi, wi, Kn);
	let qn = {};
	qn.mousedown = Un, qn.mousemove = Fn, qn.mouseup = Wn, qn.dblclick = Gn, qn.setSeries = (e, t, n, i) => {
		let a = Zn.match[2];
		n = a(r, t, n), n != -1 && pn(n, i, !0, !1);
	}, oe && (be(fi, m, Un), be(di, m, Fn), be(mi, m, (e) => {
		We(e), Pn(!1);
	}), be(hi, m, q), be(gi, m, Gn), bc.add(r), r.syncRect = Pn);
	let Jn = r.hooks = e.hooks || {};
	function Yn(e, t, n) {
		Ht ? Ut.push([
			e,
			t,
			n
		]) : e in Jn && Jn[e].forEach((e) => {
			e.call(null, r, t, n);
		});
	}
	(e.plugins || []).forEach((e) => {
		for (let t in e.hooks) Jn[t] = (Jn[t] || []).concat(e.hooks[t]);
	});
	let Xn = (e, t, n) => n, Zn = Za({
		key: null,
		setSeries: !1,
		filters: {
			pub: ka,
			sub: ka
		},
		scales: [S, v[1] ? v[1].scale : null],
		match: [
			Aa,
			Aa,
			Xn
		],
		values: [null, null]
	}, N.sync);
	Zn.match.length == 2 && Zn.match.push(Xn), N.sync = Zn;
	let Qn = Zn.key, $n = Vs(Qn);
	function er(e, t, n, r, i, a, o) {
		Zn.filters.pub(e, t, n, r, i, a, o) && $n.pub(e, t, n, r, i, a, o);
	}
	$n.sub(r);
	function tr(e, t, n, r, i, a, o) {
		Zn.filters.sub(e, t, n, r, i, a, o) && qn[e](null, t, n, r, i, a, o);
	}
	r.pub = tr;
	function nr() {
		$n.unsub(r), bc.delete(r), ye.clear(), Hi(bi, wi, Kn), l.remove(), F?.remove(), Yn("destroy");
	}
	r.destroy = nr;
	function rr() {
		Yn("init", e, t), ft(t || e.data, !1), j[S] ? qt(S, j[S]) : pt(), Ie = K.show && (K.width > 0 || K.height > 0), Fe = Le = !0, Re(e.width, e.height);
	}
	return v.forEach($e), y.forEach(rt), n ? n instanceof HTMLElement ? (n.appendChild(l), rr()) : n(r, rr) : rr(), r;
}
Lc.assign = Za, Lc.fmtNum = oa, Lc.rangeNum = na, Lc.rangeLog = Xi, Lc.rangeAsinh = Zi, Lc.orient = Ws, Lc.pxRatio = J, Lc.join = no, Lc.fmtDate = go, Lc.tzDate = vo, Lc.sync = Vs;
{
	Lc.addGap = Ys, Lc.clipGaps = Js;
	let e = Lc.paths = { points: lc };
	e.linear = pc, e.stepped = mc, e.bars = gc, e.spline = vc;
}
// src/phase.tsx
var [Rc, zc] = [420, 300], $ = {
	left: 64,
	right: 12,
	top: 10,
	bottom: 34
};
function Bc({ store: e, state: t }) {
	let [n, r] = V(null), [i, a] = t.plotted, o = t.run, [s, c] = t.span;
	if (H(() => {
		if (!i || !a) return;
		let t = !1;
		return e.transport.ask("phase", {
			run: o.run,
			names: [i, a],
			t0: s,
			t1: c
		}).then((e) => !t && r(e)).catch((n) => !t && e.refused(n)), () => {
			t = !0;
		};
	}, [
		o.run,
		i,
		a,
		s,
		c
	]), !i || !a) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "Plot two signals: the second is drawn over the first."
	});
	if (!n) return null;
	let [l, u, d, f] = n.box, [p, m] = [u - l || 1, f - d || 1], h = (e) => $.left + (e - l) / p * (Rc - $.left - $.right), g = (e) => zc - $.bottom - (e - d) / m * (zc - $.top - $.bottom), _ = (e, t, n) => `${h(e[n]).toFixed(1)},${g(t[n]).toFixed(1)}`, v = (e) => e[e.length - 1], y = n.pieces.slice(1).map(([e, t], r) => {
		let [i, a] = n.pieces[r];
		return {
			x1: h(v(i)),
			y1: g(v(a)),
			x2: h(e[0]),
			y2: g(t[0])
		};
	}), b = t.cursor?.signals, x = b && b[i] != null && b[a] != null ? [h(b[i]), g(b[a])] : null;
	return /* @__PURE__ */ z("figure", {
		class: "phase",
		"aria-label": `${a} over ${i}`,
		children: /* @__PURE__ */ z("svg", {
			viewBox: `0 0 ${Rc} ${zc}`,
			role: "img",
			"aria-label": `${a} over ${i}, from ${Se(l)} to ${Se(u)} ${n.units[0]} and from ${Se(d)} to ${Se(f)} ${n.units[1]}`,
			children: [
				/* @__PURE__ */ z("rect", {
					class: "box",
					x: $.left,
					y: $.top,
					width: Rc - $.left - $.right,
					height: zc - $.top - $.bottom
				}),
				l < 0 && u > 0 && /* @__PURE__ */ z("line", {
					class: "axis",
					x1: h(0),
					x2: h(0),
					y1: $.top,
					y2: zc - $.bottom
				}),
				d < 0 && f > 0 && /* @__PURE__ */ z("line", {
					class: "axis",
					x1: $.left,
					x2: Rc - $.right,
					y1: g(0),
					y2: g(0)
				}),
				y.map((e) => Math.hypot(e.x2 - e.x1, e.y2 - e.y1) > 1 && /* @__PURE__ */ z("line", {
					class: "jump",
					...e
				})),
				n.pieces.map(([e, t]) => /* @__PURE__ */ z("path", {
					class: "way",
					d: `M${e.map((n, r) => _(e, t, r)).join("L")}`
				})),
				x && /* @__PURE__ */ z("circle", {
					class: "now",
					cx: x[0],
					cy: x[1],
					r: 4.5
				}),
				/* @__PURE__ */ z("text", {
					x: $.left,
					y: zc - $.bottom + 14,
					children: R(l, n.units[0])
				}),
				/* @__PURE__ */ z("text", {
					x: Rc - $.right,
					y: zc - $.bottom + 14,
					"text-anchor": "end",
					children: R(u, n.units[0])
				}),
				/* @__PURE__ */ z("text", {
					x: (Rc + $.left) / 2,
					y: zc - 6,
					"text-anchor": "middle",
					class: "what",
					children: i
				}),
				/* @__PURE__ */ z("text", {
					x: $.left - 5,
					y: zc - $.bottom,
					"text-anchor": "end",
					children: R(d, n.units[1])
				}),
				/* @__PURE__ */ z("text", {
					x: $.left - 5,
					y: $.top + 10,
					"text-anchor": "end",
					children: R(f, n.units[1])
				}),
				/* @__PURE__ */ z("text", {
					transform: `translate(12,${(zc - $.bottom) / 2}) rotate(-90)`,
					"text-anchor": "middle",
					class: "what",
					children: a
				})
			]
		})
	});
}
// src/plots.tsx
var Vc = [
	"--c1",
	"--c2",
	"--c3",
	"--c4",
	"--c5",
	"--c6"
];
function Hc({ store: e, state: t }) {
	let [n, r] = V(null), [i, a] = V(!1), [o, s] = V(800), c = St(null), l = t.run, [u, d] = t.span;
	H(() => {
		let e = c.current;
		if (!e) return;
		let t = new ResizeObserver(() => s(Math.max(200, e.clientWidth - 18)));
		return t.observe(e), () => t.disconnect();
	}, [!l]);
	let f = t.plotted.join("\n");
	if (H(() => {
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
	]), t.running && t.soFar) return /* @__PURE__ */ z(Uc, {
		state: t,
		soFar: t.soFar
	});
	if (!l || l.tEnd === void 0) return /* @__PURE__ */ z("p", {
		class: "hint plots",
		children: [
			l?.error ? "" : t.running ? "Running …" : "Press Run.",
			" ",
			t.plan && /* @__PURE__ */ z("button", {
				onClick: () => e.set({ planShown: !0 }),
				children: "← Sweep"
			})
		]
	});
	let p = t.cursor?.t ?? null, m = u === l.tBegin && d === l.tEnd;
	return /* @__PURE__ */ z("div", {
		class: "plots",
		ref: c,
		children: [
			/* @__PURE__ */ z("div", {
				class: "plotbar",
				children: [
					t.plan && /* @__PURE__ */ z("button", {
						onClick: () => e.set({ planShown: !0 }),
						children: "← Sweep"
					}),
					l.own && /* @__PURE__ */ z("b", {
						class: "own",
						children: l.title
					}),
					/* @__PURE__ */ z(Wc, {
						store: e,
						state: t,
						run: l
					}),
					t.runs.length > 1 && /* @__PURE__ */ z("label", { children: [
						/* @__PURE__ */ z("input", {
							type: "checkbox",
							checked: i,
							onChange: (e) => a(e.currentTarget.checked)
						}),
						" compare ",
						t.runs.length,
						" runs"
					] }),
					!m && /* @__PURE__ */ z("button", {
						onClick: () => e.set({ span: [l.tBegin, l.tEnd] }),
						children: "Whole run"
					}),
					/* @__PURE__ */ z("label", {
						class: "scrub",
						children: [
							/* @__PURE__ */ z("span", { children: "t" }),
							/* @__PURE__ */ z("input", {
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
							/* @__PURE__ */ z("output", { children: p === null ? "" : R(p, "s") })
						]
					}),
					/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("input", {
						type: "checkbox",
						checked: t.phase,
						onChange: (t) => e.set({ phase: t.currentTarget.checked })
					}), " phase plane"] }),
					/* @__PURE__ */ z("label", { children: [/* @__PURE__ */ z("input", {
						type: "checkbox",
						checked: t.flowing,
						onChange: (t) => e.set({ flowing: t.currentTarget.checked })
					}), " power along bonds"] })
				]
			}),
			l.doubt && /* @__PURE__ */ z("p", {
				class: "doubt",
				children: l.doubt.said
			}),
			t.plotted.map((r, i) => /* @__PURE__ */ z(Gc, {
				name: r,
				ink: Vc[i % Vc.length],
				curves: (n?.runs ?? []).flatMap((e) => e.curves.filter((e) => e.name === r)),
				span: t.span,
				cursor: p,
				value: t.cursor?.signals[r] ?? null,
				wide: o,
				dark: t.dark,
				last: i === t.plotted.length - 1,
				doubt: l.doubt?.t,
				onSpan: (t) => e.set({ span: t }),
				onTime: (t) => {
					e.set({ instant: null }), e.moveCursor(t);
				}
			}, r)),
			t.phase && /* @__PURE__ */ z(Bc, {
				store: e,
				state: t
			}),
			/* @__PURE__ */ z(Yc, {
				lanes: n?.strip ?? [],
				span: t.span,
				cursor: p,
				onTime: (t) => void e.moveCursor(t)
			})
		]
	});
}
function Uc({ state: e, soFar: t }) {
	let n = St(null), r = [t.tBegin, t.tEnd];
	return /* @__PURE__ */ z("div", {
		class: "plots",
		ref: n,
		children: [t.curves.map((i, a) => /* @__PURE__ */ z(Gc, {
			name: i.name,
			ink: Vc[a % Vc.length],
			curves: [i],
			span: r,
			cursor: null,
			value: null,
			wide: (n.current?.clientWidth ?? 800) - 18,
			dark: e.dark,
			last: a === t.curves.length - 1,
			onSpan: () => {},
			onTime: () => {}
		}, i.name)), /* @__PURE__ */ z(Yc, {
			lanes: t.strip,
			span: r,
			cursor: null,
			onTime: () => {}
		})]
	});
}
function Wc({ store: e, state: t, run: n }) {
	let r = (t.look?.view.nodes ?? []).flatMap((e) => e.kind === "part" ? [] : [`${e.name}.e`, `${e.name}.f`]), i = [.../* @__PURE__ */ new Set([...n.names, ...r])].filter((e) => !t.plotted.includes(e));
	return /* @__PURE__ */ z("span", {
		class: "chooser",
		children: [
			t.plotted.map((n) => /* @__PURE__ */ z("button", {
				class: "chip",
				"aria-label": `Do not plot ${n}`,
				onClick: () => e.set({ plotted: t.plotted.filter((e) => e !== n) }),
				children: [n, " ✕"]
			})),
			/* @__PURE__ */ z("input", {
				"aria-label": "Plot a signal",
				placeholder: "plot …",
				list: "signals",
				onKeyDown: (e) => e.stopPropagation(),
				onChange: (n) => {
					let r = n.currentTarget.value.trim();
					r && e.set({ plotted: [...t.plotted, r] }), n.currentTarget.value = "";
				}
			}),
			/* @__PURE__ */ z("datalist", {
				id: "signals",
				children: i.map((e) => /* @__PURE__ */ z("option", { value: e }))
			})
		]
	});
}
var Gc = class extends S {
	box = b();
	plot = null;
	componentDidMount() {
		this.draw();
	}
	componentDidUpdate(e) {
		let t = this.props;
		e.wide === t.wide && e.dark === t.dark && e.last === t.last && e.doubt === t.doubt && e.curves.length === t.curves.length && e.curves.every((e, n) => e === t.curves[n]) ? e.cursor !== t.cursor && this.plot?.redraw(!1) : this.draw();
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
		let s = getComputedStyle(a), c = s.getPropertyValue("--ink"), l = s.getPropertyValue("--line"), u = o.map((e, t) => s.getPropertyValue(t === o.length - 1 ? this.props.ink : Vc[(t + 3) % Vc.length])), d = o.map((e) => [e.t, e.y]), f = d.length === 1 ? d[0] : Lc.join(d), p = o[o.length - 1].unit, m = o.flatMap((e) => e.impulses);
		this.plot = new Lc({
			width: Math.max(n - 4, 200),
			height: r ? 138 : 118,
			padding: [
				14,
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
				y: { range: (e, t, n) => Kc(t, n, m.length > 0) }
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
				values: (e, t) => qc(t, "s")
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
				values: (e, t) => qc(t, p)
			}],
			series: [{}, ...o.map((e, t) => ({
				stroke: u[t],
				width: 1.5,
				points: { show: !1 },
				pxAlign: 0,
				spanGaps: d.length > 1
			}))],
			hooks: {
				drawClear: [(e) => this.doubted(e, s.getPropertyValue("--doubt"))],
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
				let e = `${R(f, L(r))} δ`, t = p + 8 * d + u.measureText(e).width < a + s;
				u.textAlign = t ? "left" : "right", u.fillText(e, p + (t ? 6 : -6) * d, (l + h) / 2);
			}
		}
		u.restore();
	}
	doubted(e, t) {
		let n = this.props.doubt;
		if (n === void 0) return;
		let { left: r, top: i, width: a, height: o } = e.bbox, s = Math.max(e.valToPos(n, "x", !0), r);
		if (s > r + a) return;
		let c = e.ctx;
		c.save(), c.fillStyle = c.strokeStyle = t, c.globalAlpha = .12, c.fillRect(s, i, r + a - s, o), c.globalAlpha = 1, c.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]), c.beginPath(), c.moveTo(s, i), c.lineTo(s, i + o), c.stroke(), c.restore();
	}
	timeline(e, t) {
		let n = this.props.cursor;
		if (n === null) return;
		let r = e.valToPos(n, "x", !0), { left: i, top: a, width: o, height: s } = e.bbox;
		r < i || r > i + o || (e.ctx.save(), e.ctx.strokeStyle = t, e.ctx.setLineDash([4, 3]), e.ctx.beginPath(), e.ctx.moveTo(r, a), e.ctx.lineTo(r, a + s), e.ctx.stroke(), e.ctx.restore());
	}
	render({ name: e, curves: t, value: n, cursor: r }) {
		let i = t.find((e) => e.error);
		return /* @__PURE__ */ z("figure", {
			class: "trace",
			"aria-label": `Plot of ${e}`,
			children: [
				/* @__PURE__ */ z("div", { ref: this.box }),
				r !== null && /* @__PURE__ */ z("output", {
					class: "reading",
					children: R(n, t.find((e) => !e.error)?.unit ?? "")
				}),
				i && /* @__PURE__ */ z("p", {
					class: "hint",
					children: [
						i.error.code,
						" ",
						i.error.why
					]
				})
			]
		});
	}
};
function Kc(e, t, n) {
	let [r, i] = [e ?? 0, t ?? 1];
	n && ([r, i] = [Math.min(r, 0), Math.max(i, 0)]);
	let a = .08 * (i - r) || .1 * Math.abs(r) || 1;
	return [r - a, i + a];
}
function qc(e, t) {
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
	return e.map((e) => a ? `${+(e / r).toPrecision(5)} ${i}${t}` : `${+e.toPrecision(5)} ${I(t)}`);
}
var Jc = [
	"var(--s0)",
	"var(--s1)",
	"var(--s2)",
	"var(--s3)",
	"var(--s4)",
	"var(--s5)",
	"var(--s6)",
	"var(--s7)"
];
function Yc({ lanes: e, span: [t, n], cursor: r, onTime: i }) {
	if (!e.length) return null;
	let a = (e) => 1e3 * (e - t) / (n - t || 1);
	return /* @__PURE__ */ z("div", {
		class: "strip",
		children: [
			/* @__PURE__ */ z("div", {
				class: "stripnames",
				"aria-hidden": "true",
				children: e.map((e) => /* @__PURE__ */ z("span", {
					title: e.machine,
					children: e.machine
				}))
			}),
			/* @__PURE__ */ z("svg", {
				viewBox: `0 0 1000 ${18 * e.length}`,
				preserveAspectRatio: "none",
				style: { height: `${18 * e.length}px` },
				role: "img",
				"aria-label": `Modes: ${e.map((e) => `${e.machine} is ${e.stays?.map(([, , t]) => e.states[t]).slice(0, 12).join(", ") ?? "switching fast"}`).join("; ")}`,
				onClick: (e) => {
					let r = e.currentTarget.getBoundingClientRect();
					i(t + (e.clientX - r.left) / r.width * (n - t));
				},
				children: [e.map((e, r) => /* @__PURE__ */ z("g", {
					transform: `translate(0,${r * 18})`,
					children: [e.stays?.map(([r, i, o]) => /* @__PURE__ */ z("rect", {
						x: a(Math.max(r, t)),
						width: Math.max(.7, a(Math.min(i, n)) - a(Math.max(r, t))),
						y: 1,
						height: 16,
						fill: Jc[o % Jc.length],
						children: /* @__PURE__ */ z("title", { children: e.states[o] })
					})), e.shares?.map((e, t) => e.map((n, r) => n > 0 ? /* @__PURE__ */ z("rect", {
						x: 1e3 * r / e.length,
						width: 1e3 / e.length,
						y: 1,
						height: 16,
						fill: Jc[t % Jc.length],
						opacity: n
					}) : null))]
				})), r !== null && r >= t && r <= n && /* @__PURE__ */ z("line", {
					class: "now",
					x1: a(r),
					x2: a(r),
					y1: 0,
					y2: 18 * e.length
				})]
			}),
			/* @__PURE__ */ z("div", {
				class: "stripwords",
				"aria-hidden": "true",
				children: e.map((e, r) => e.stays?.filter(([e, r]) => a(Math.min(r, n)) - a(Math.max(e, t)) > 60).map(([i, o, s]) => /* @__PURE__ */ z("span", {
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
// src/power.tsx
var Xc = {
	C: ["gives back", "stores"],
	I: ["gives back", "stores"],
	R: ["gives", "dissipates"],
	G: ["gives", "dissipates"],
	Se: ["supplies", "absorbs"],
	Sf: ["supplies", "absorbs"]
}, Zc = 150, [Qc, $c, el, tl] = [
	310,
	17,
	7,
	10
];
function nl(e) {
	let t = e.cursor?.values ?? {}, { nodes: n, bonds: r } = e.look.view, i = /* @__PURE__ */ new Map();
	for (let e of r) {
		let n = t[e.key];
		if (!n || n.power === !1) continue;
		let r = n.e === null || n.f === null ? null : n.e * n.f;
		for (let [t, n] of [[e.tail, -1], [e.head, 1]]) {
			let e = i.get(t) === void 0 ? 0 : i.get(t);
			i.set(t, r === null || e === null ? null : e + n * r);
		}
	}
	let a = n.filter((e) => e.kind !== "0" && e.kind !== "1" && e.kind !== "TF" && e.kind !== "GY" && i.has(e.name));
	return {
		found: a.filter((e) => i.get(e.name) !== null).map((e) => ({
			node: e,
			power: i.get(e.name)
		})),
		unknown: a.filter((e) => i.get(e.name) === null).map((e) => e.name)
	};
}
function rl({ gives: e, takes: t }) {
	let n = (e) => e.reduce((e, t) => e + t.size, 0), r = Math.max(n(e), n(t)) || 1, i = Math.max(1, e.length, t.length), a = i * ($c + el) + 120, o = (a - i * el - 8) / r, s = (e, t) => {
		let n = 4, r = 4;
		return e.map((e) => {
			let i = e.size * o, [a, s] = [n, r];
			n += Math.max(i, 1) + el, r += i;
			let [c, l] = t ? [tl, Qc / 2 - tl / 2] : [Qc - tl, Qc / 2 + tl / 2], u = (c + l) / 2;
			return /* @__PURE__ */ z("g", {
				class: "flow " + (t ? "gives" : "takes"),
				onClick: e.select,
				children: [
					/* @__PURE__ */ z("path", { d: `M${c},${a}C${u},${a} ${u},${s} ${l},${s}V${s + i}C${u},${s + i} ${u},${a + i} ${c},${a + i}Z` }),
					/* @__PURE__ */ z("rect", {
						x: t ? 0 : Qc - tl,
						y: a,
						width: tl,
						height: Math.max(i, 1)
					}),
					/* @__PURE__ */ z("text", {
						x: t ? tl + 4 : Qc - tl - 4,
						y: a + Math.max(i, 1) / 2 + 4,
						"text-anchor": t ? "start" : "end",
						children: e.name
					})
				]
			});
		});
	};
	return /* @__PURE__ */ z("svg", {
		class: "sankey",
		viewBox: `0 0 ${Qc} ${a}`,
		role: "img",
		"aria-label": `Sankey diagram: ${e.map((e) => e.name).join(", ")} give, ${t.map((e) => e.name).join(", ")} take`,
		children: [
			s(e, !0),
			s(t, !1),
			/* @__PURE__ */ z("rect", {
				class: "middle-bar",
				x: Qc / 2 - tl / 2,
				y: 4,
				width: tl,
				height: r * o
			})
		]
	});
}
function il({ store: e, state: t }) {
	let [n, r] = V(!1);
	return t.cursor ? /* @__PURE__ */ z("section", {
		class: "power-panel",
		children: [/* @__PURE__ */ z("div", {
			class: "row",
			role: "group",
			"aria-label": "What is shown",
			children: [/* @__PURE__ */ z("button", {
				"aria-pressed": !n,
				onClick: () => r(!1),
				children: "Power at the cursor"
			}), /* @__PURE__ */ z("button", {
				"aria-pressed": n,
				onClick: () => r(!0),
				children: "Energy up to it"
			})]
		}), z(n ? al : ol, {
			store: e,
			state: t
		})]
	}) : /* @__PURE__ */ z("p", {
		class: "hint",
		children: "Run the model and choose a time in its plots."
	});
}
function al({ store: e, state: t }) {
	let [n, r] = V(null), i = t.cursor.t, a = t.run?.run;
	if (H(() => {
		let t = !1, n = setTimeout(() => {
			e.transport.ask("energies", {
				run: a,
				t: i
			}).then((e) => !t && r(e)).catch((t) => e.refused(t));
		}, Zc);
		return () => {
			t = !0, clearTimeout(n);
		};
	}, [a, i]), !n) return /* @__PURE__ */ z("p", {
		class: "hint",
		children: "…"
	});
	let o = new Set(t.look.view.nodes.map((e) => e.name)), s = (t) => ({
		name: t.name,
		size: t.energy,
		select: o.has(t.name) ? () => e.set({
			nodes: /* @__PURE__ */ new Set([t.name]),
			bonds: /* @__PURE__ */ new Set()
		}) : void 0
	}), c = (e) => e.reduce((e, t) => e + t.energy, 0);
	return /* @__PURE__ */ z(x, { children: [
		/* @__PURE__ */ z("h2", { children: [
			"Energy from ",
			R(n.start, "s"),
			" to ",
			R(n.end, "s")
		] }),
		n.gives.length + n.takes.length > 0 ? /* @__PURE__ */ z(rl, {
			gives: n.gives.map(s),
			takes: n.takes.map(s)
		}) : /* @__PURE__ */ z("p", {
			class: "hint",
			children: "No energy has flowed."
		}),
		/* @__PURE__ */ z("table", { children: [/* @__PURE__ */ z("thead", { children: /* @__PURE__ */ z("tr", { children: [
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "element"
			}),
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "did"
			}),
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "energy"
			})
		] }) }), /* @__PURE__ */ z("tbody", { children: [...n.gives.map((e) => [e, "gave"]), ...n.takes.map((e) => [e, "took"])].map(([e, t]) => /* @__PURE__ */ z("tr", { children: [
			/* @__PURE__ */ z("td", { children: e.name }),
			/* @__PURE__ */ z("td", { children: t }),
			/* @__PURE__ */ z("td", {
				class: "figure",
				children: R(e.energy, "J")
			})
		] })) })] }),
		/* @__PURE__ */ z("p", {
			class: "hint",
			children: [
				"given ",
				R(c(n.gives), "J"),
				", taken ",
				R(c(n.takes), "J")
			]
		})
	] });
}
function ol({ store: e, state: t }) {
	let { found: n, unknown: r } = nl(t), i = Math.max(0, ...n.map((e) => Math.abs(e.power))), a = n.filter((e) => Math.abs(e.power) > 1e-6 * i).sort((e, t) => Math.abs(t.power) - Math.abs(e.power)), o = a.filter((e) => e.power < 0), s = a.filter((e) => e.power > 0), c = (e) => e.reduce((e, t) => e + Math.abs(t.power), 0), l = (t) => e.set({
		nodes: /* @__PURE__ */ new Set([t.name]),
		bonds: /* @__PURE__ */ new Set()
	}), u = (e) => ({
		name: e.node.name,
		size: Math.abs(e.power),
		select: () => l(e.node)
	});
	return /* @__PURE__ */ z(x, { children: [
		/* @__PURE__ */ z("h2", { children: ["Power at t = ", R(t.cursor.t, "s")] }),
		a.length > 0 ? /* @__PURE__ */ z(rl, {
			gives: o.map(u),
			takes: s.map(u)
		}) : /* @__PURE__ */ z("p", {
			class: "hint",
			children: "No power flows."
		}),
		/* @__PURE__ */ z("table", { children: [/* @__PURE__ */ z("thead", { children: /* @__PURE__ */ z("tr", { children: [
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "element"
			}),
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "does"
			}),
			/* @__PURE__ */ z("th", {
				scope: "col",
				children: "power"
			})
		] }) }), /* @__PURE__ */ z("tbody", { children: a.map((e) => /* @__PURE__ */ z("tr", {
			class: t.nodes.has(e.node.name) ? "chosen" : "",
			children: [
				/* @__PURE__ */ z("td", { children: /* @__PURE__ */ z("button", {
					class: "link",
					onClick: () => l(e.node),
					children: e.node.name
				}) }),
				/* @__PURE__ */ z("td", { children: (Xc[e.node.kind] ?? ["gives", "takes"])[+(e.power > 0)] }),
				/* @__PURE__ */ z("td", {
					class: "figure",
					children: R(Math.abs(e.power), "W")
				})
			]
		})) })] }),
		r.length > 0 && /* @__PURE__ */ z("p", {
			class: "hint",
			children: ["not determined: ", r.join(", ")]
		}),
		/* @__PURE__ */ z("p", {
			class: "hint",
			children: [
				"supplied and given back ",
				R(c(o), "W"),
				", taken ",
				R(c(s), "W")
			]
		})
	] });
}
// src/splitter.tsx
function sl(e) {
	let t = (t) => e.onChange(Math.round(Math.max(e.least, Math.min(e.most, t))));
	return /* @__PURE__ */ z("div", {
		class: "splitter " + (e.upright ? "upright" : "level"),
		role: "separator",
		tabindex: 0,
		"aria-label": e.label,
		"aria-orientation": e.upright ? "vertical" : "horizontal",
		"aria-valuenow": e.value,
		"aria-valuemin": e.least,
		"aria-valuemax": e.most,
		onPointerDown: (n) => {
			let r = n.currentTarget;
			r.setPointerCapture(n.pointerId);
			let i = e.upright ? n.clientX : n.clientY, a = (n) => t(e.value + e.sign * ((e.upright ? n.clientX : n.clientY) - i)), o = () => {
				r.removeEventListener("pointermove", a), r.removeEventListener("pointerup", o);
			};
			r.addEventListener("pointermove", a), r.addEventListener("pointerup", o);
		},
		onKeyDown: (n) => {
			let r = {
				ArrowLeft: -1,
				ArrowRight: 1,
				ArrowUp: -1,
				ArrowDown: 1
			}[n.key];
			r && /Left|Right/.test(n.key) === e.upright && (n.preventDefault(), n.stopPropagation(), t(e.value + 20 * r * e.sign));
		}
	});
}
// src/transport.ts
var cl = class extends Error {
	problem;
	constructor(e) {
		super(e.why), this.problem = e;
	}
}, ll = class {
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
			e.error ? t.failed(new cl(e.error)) : t.done(e);
		} else this.onTold(e);
	}
};
// src/schematic.tsx
function ul({ store: e, state: t }) {
	let [n, r] = V(null), [i, a] = V(""), o = t.look, s = o.view.nodes.map((e) => `${e.x},${e.y}`).join(" ");
	H(() => {
		let t = !1;
		return e.transport.ask("schematic", { level: o.view.path }).then((e) => {
			t || (r(e), a(""));
		}).catch((e) => {
			t || (r(null), a(e instanceof cl ? `${e.problem.why}. ${e.problem.try ?? ""}` : String(e)));
		}), () => {
			t = !0;
		};
	}, [
		o.revision,
		o.view.path,
		s
	]);
	let c = (e) => o.view.bonds.find((t) => `${t.ends[0]} -> ${t.ends[1]}` === e)?.key, l = (e, n) => e === "wire" ? t.bonds.has(c(n) ?? "") : t.nodes.has(n), u = t.cursor?.strokes ?? o.strokes, d = (e, t) => (u.bonds[e] ?? u.bonds[`${t[0]} -> ${t[1]}`])?.off, f = (e, t) => {
		if (e === "wire") return o.view.bonds.some((e) => `${e.ends[0]} -> ${e.ends[1]}` === t && d(e.key, e.ends));
		let n = o.view.bonds.filter((e) => e.tail === t || e.head === t);
		return u.nodes[t]?.off || n.length > 0 && n.every((e) => d(e.key, e.ends));
	}, p = (n, r, i) => {
		let a = n.shiftKey || n.ctrlKey || n.metaKey, o = t.tab === "power" ? t.tab : "item";
		if (r === "wire") {
			let n = c(i);
			n && e.set({
				bonds: new Set(a ? [...t.bonds, n] : [n]),
				nodes: a ? t.nodes : /* @__PURE__ */ new Set(),
				tab: o
			});
		} else i && e.set({
			nodes: new Set(a ? [...t.nodes, i] : [i]),
			bonds: a ? t.bonds : /* @__PURE__ */ new Set(),
			tab: o
		});
	}, m = (n, r) => {
		let i = o.view.nodes.find((e) => e.name === r);
		n === "part" && i?.kind === "part" && i.known && e.open(t.level ? `${t.level}.${r}` : r);
	};
	return /* @__PURE__ */ z("section", {
		class: "schematic",
		"aria-label": "Schematic",
		children: [i && /* @__PURE__ */ z("p", {
			class: "hint",
			children: i
		}), n && /* @__PURE__ */ z("svg", {
			viewBox: `0 0 ${n.width} ${n.height}`,
			style: { maxWidth: `${n.width * 1.6}px` },
			role: "img",
			"aria-label": `Schematic: ${n.groups.filter((e) => e.name === "part").map((e) => e.key).join(", ")}`,
			children: n.groups.map((e) => /* @__PURE__ */ z("g", {
				class: e.name + (l(e.name, e.key) ? " selected" : "") + (f(e.name, e.key) ? " off" : ""),
				"data-schematic": e.key,
				onClick: (t) => p(t, e.name, e.key),
				onDblClick: () => m(e.name, e.key),
				children: [e.about && /* @__PURE__ */ z("title", { children: e.about }), e.marks.map((e) => e.d === void 0 ? /* @__PURE__ */ z("text", {
					class: e.role,
					x: e.x,
					y: e.y,
					"text-anchor": e.anchor,
					children: e.text
				}) : /* @__PURE__ */ z(x, { children: [/* @__PURE__ */ z("path", {
					class: "reach",
					d: e.d
				}), /* @__PURE__ */ z("path", {
					class: e.role,
					d: e.d
				})] }))]
			}))
		})]
	});
}
// src/app.tsx
var dl = [
	["item", "Properties"],
	["machines", "Machines"],
	["model", "Model"],
	["problems", "Problems"],
	["table", "Table"],
	["text", "Text"],
	["equations", "Equations"],
	["power", "Power"],
	["plan", "Sweep"]
], fl = class extends S {
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
		let t = e.ctrlKey || e.metaKey, { store: n, whole: r } = this.props;
		if (r && document.activeElement === document.body && e.key !== "Tab") {
			let t = document.querySelector(".canvas svg");
			t?.focus({ preventScroll: !0 }), t && !t.dispatchEvent(new KeyboardEvent(e.type, e)) && e.preventDefault();
			return;
		}
		if (!t || !this.onCanvas()) return;
		let i = e.key.toLowerCase();
		if (i === "z" && !e.shiftKey) n.undo();
		else if (i === "y" || i === "z" && e.shiftKey) n.redo();
		else if (i !== "s") {
			if (i === "enter") n.start();
			else return;
		}
		e.preventDefault();
	};
	render({ store: e }, t) {
		let n = t.look;
		if (!n) return /* @__PURE__ */ z("div", {
			class: "studio loading",
			role: "status",
			children: t.connected ? "Opening …" : "Connecting …"
		});
		let r = t.dark === null ? "" : t.dark ? " dark" : " light", i = n.problems.filter((e) => e.grave === "error").length, a = n.problems.length - i, o = [...t.nodes, ...[...t.bonds].map((e) => n.view.bonds.find((t) => t.key === e)?.text)].join(", ");
		return /* @__PURE__ */ z("main", {
			class: "studio" + r + (t.bottom ? " withbottom" : ""),
			style: `--side: ${t.room.side}px; --low: ${t.room.low ? `${t.room.low}px` : "44%"}`,
			children: [
				/* @__PURE__ */ z(ml, {
					store: e,
					state: t,
					errors: i
				}),
				/* @__PURE__ */ z("div", {
					class: "middle",
					children: [
						/* @__PURE__ */ z(An, {
							store: e,
							state: t
						}),
						/* @__PURE__ */ z("div", {
							class: "canvases" + (t.schematic ? " two" : ""),
							children: [/* @__PURE__ */ z(it, {
								store: e,
								state: t
							}), t.schematic && /* @__PURE__ */ z(ul, {
								store: e,
								state: t
							})]
						}),
						/* @__PURE__ */ z(sl, {
							upright: !0,
							label: "Width of the panels",
							value: t.room.side,
							least: 220,
							most: 900,
							sign: -1,
							onChange: (n) => e.set({ room: {
								...t.room,
								side: n
							} })
						}),
						/* @__PURE__ */ z("aside", {
							class: "side" + (t.panel === "side" ? " open" : ""),
							"aria-label": "Panels",
							children: [/* @__PURE__ */ z("div", {
								class: "tabs",
								role: "tablist",
								"aria-label": "Panels",
								children: dl.map(([r, a]) => /* @__PURE__ */ z("button", {
									role: "tab",
									id: `tab-${r}`,
									"aria-controls": "panel",
									"aria-selected": t.tab === r,
									onClick: () => e.set({ tab: r }),
									children: [a, r === "problems" && n.problems.length > 0 && /* @__PURE__ */ z("span", {
										class: "count" + (i ? " error" : ""),
										children: n.problems.length
									})]
								}))
							}), /* @__PURE__ */ z("div", {
								class: "panel",
								id: "panel",
								role: "tabpanel",
								"aria-labelledby": `tab-${t.tab}`,
								tabindex: 0,
								children: [
									t.tab === "item" && /* @__PURE__ */ z(Jt, {
										store: e,
										state: t
									}),
									t.tab === "machines" && /* @__PURE__ */ z(K, {
										store: e,
										state: t
									}),
									t.tab === "model" && /* @__PURE__ */ z(Sn, {
										store: e,
										state: t
									}),
									t.tab === "problems" && /* @__PURE__ */ z(En, {
										store: e,
										state: t
									}),
									t.tab === "table" && /* @__PURE__ */ z(Dn, {
										store: e,
										state: t
									}),
									t.tab === "text" && /* @__PURE__ */ z(On, {
										store: e,
										state: t
									}),
									t.tab === "equations" && /* @__PURE__ */ z(Ut, {
										store: e,
										state: t
									}),
									t.tab === "power" && /* @__PURE__ */ z(il, {
										store: e,
										state: t
									}),
									t.tab === "plan" && /* @__PURE__ */ z(Qn, {
										store: e,
										state: t
									})
								]
							})]
						})
					]
				}),
				t.bottom && /* @__PURE__ */ z("div", {
					class: "bottom",
					children: [/* @__PURE__ */ z(sl, {
						upright: !1,
						label: "Height of the plots",
						value: t.room.low || 320,
						least: 120,
						most: 900,
						sign: -1,
						onChange: (n) => e.set({ room: {
							...t.room,
							low: n
						} })
					}), t.planShown && t.plan ? /* @__PURE__ */ z(Tr, {
						store: e,
						state: t,
						plan: t.plan
					}) : /* @__PURE__ */ z(x, { children: [t.sweep ? /* @__PURE__ */ z(vn, {
						store: e,
						state: t
					}) : /* @__PURE__ */ z(Hc, {
						store: e,
						state: t
					}), /* @__PURE__ */ z(Nt, {
						store: e,
						state: t
					})] })]
				}),
				/* @__PURE__ */ z("footer", { children: [
					/* @__PURE__ */ z("span", {
						id: "chosen",
						role: "status",
						"aria-live": "polite",
						children: o || (n.whole ? "" : "strokes of what is joined so far")
					}),
					/* @__PURE__ */ z(pl, {
						store: e,
						state: t
					}),
					/* @__PURE__ */ z("button", {
						class: "verdict" + (i ? " error" : a ? " hint" : ""),
						onClick: () => e.set({
							tab: "problems",
							panel: "side"
						}),
						children: i ? `${i} ${i === 1 ? "problem" : "problems"}: ${n.problems[0].code} ${n.problems[0].where}` : a ? `${a} hint${a > 1 ? "s" : ""}` : "fine"
					}),
					/* @__PURE__ */ z("button", {
						class: "verdict",
						"aria-pressed": t.bottom,
						onClick: () => e.set({ bottom: !t.bottom }),
						children: "plots"
					})
				] }),
				t.adding && n.view.editable && /* @__PURE__ */ z(Ln, {
					store: e,
					state: t
				}),
				t.finding && /* @__PURE__ */ z(Bt, {
					store: e,
					state: t
				}),
				t.notice && /* @__PURE__ */ z("div", {
					class: "notice",
					role: "alert",
					children: [
						/* @__PURE__ */ z("b", { children: t.notice.code }),
						" ",
						t.notice.where && /* @__PURE__ */ z("i", { children: [t.notice.where, ": "] }),
						t.notice.why,
						t.notice.try && /* @__PURE__ */ z("em", { children: [" Try: ", t.notice.try] }),
						/* @__PURE__ */ z("button", {
							"aria-label": "Close this message",
							onClick: () => e.set({ notice: null }),
							children: "✕"
						})
					]
				}),
				!t.connected && /* @__PURE__ */ z("div", {
					class: "notice",
					role: "alert",
					children: "The studio does not answer. What you did is in the file; trying again …"
				})
			]
		});
	}
};
function pl({ store: e, state: t }) {
	let n = t.look.machines, r = t.cursor?.mode;
	return n.length ? /* @__PURE__ */ z("span", {
		class: "modes",
		children: [
			t.cursor && /* @__PURE__ */ z("b", { children: ["t = ", R(t.cursor.t, "s", 6)] }),
			n.slice(0, 8).map((t) => /* @__PURE__ */ z("label", { children: [t.path, /* @__PURE__ */ z("select", {
				"aria-label": `State of ${t.path} that is drawn`,
				value: r?.[t.path] ?? t.state,
				onChange: (n) => e.setMode(t.path, n.currentTarget.value),
				children: t.states.map((e) => /* @__PURE__ */ z("option", { children: e }))
			})] })),
			n.length > 8 && `and ${n.length - 8} more`
		]
	}) : null;
}
function ml({ store: e, state: t, errors: n }) {
	let r = t.look, i = t.running, a = Number(r.panels.experiment.until) || t.run?.until || 1;
	return /* @__PURE__ */ z("header", { children: [
		/* @__PURE__ */ z(hl, {
			store: e,
			state: t
		}),
		/* @__PURE__ */ z("h1", {
			title: r.file,
			children: r.title || r.file
		}),
		/* @__PURE__ */ z("span", {
			class: "saved" + (r.unsaved ? " error" : ""),
			role: "status",
			children: r.unsaved ? `not saved: ${r.unsaved}` : r.inMemory ? "in memory" : r.writable ? "saved" : "read only: open in another studio"
		}),
		/* @__PURE__ */ z("span", { class: "spring" }),
		/* @__PURE__ */ z("button", {
			class: "narrow",
			"aria-label": "Palette",
			"aria-pressed": t.panel === "palette",
			onClick: () => e.set({ panel: t.panel === "palette" ? "" : "palette" }),
			children: "+"
		}),
		/* @__PURE__ */ z("button", {
			class: "narrow",
			"aria-label": "Panels",
			"aria-pressed": t.panel === "side",
			onClick: () => e.set({ panel: t.panel === "side" ? "" : "side" }),
			children: "☰"
		}),
		/* @__PURE__ */ z("button", {
			title: "Undo (Ctrl+Z)",
			"aria-label": "Undo",
			disabled: !r.canUndo,
			onClick: e.undo,
			children: "↶"
		}),
		/* @__PURE__ */ z("button", {
			title: "Redo (Ctrl+Y)",
			"aria-label": "Redo",
			disabled: !r.canRedo,
			onClick: e.redo,
			children: "↷"
		}),
		/* @__PURE__ */ z("button", {
			class: "wide",
			disabled: !r.view.editable || !r.view.nodes.length,
			title: "Lay out anew; selected elements stay where they are",
			onClick: () => void e.arrange(),
			children: "Arrange"
		}),
		/* @__PURE__ */ z("button", {
			class: "wide",
			"aria-pressed": t.schematic,
			title: "The schematic beside the bond graph",
			disabled: !t.schematic && !r.view.nodes.some((e) => e.kind === "part"),
			onClick: () => e.set({ schematic: !t.schematic }),
			children: "Schematic"
		}),
		i ? /* @__PURE__ */ z(x, { children: [/* @__PURE__ */ z("progress", {
			"aria-label": "Progress of the run",
			max: a,
			value: i.t
		}), /* @__PURE__ */ z("button", {
			class: "run",
			onClick: e.cancel,
			children: "Cancel"
		})] }) : /* @__PURE__ */ z("button", {
			class: "run",
			disabled: n > 0,
			title: "Run (Ctrl+Enter)",
			onClick: () => void e.start(),
			children: "▶ Run"
		}),
		/* @__PURE__ */ z("button", {
			"aria-label": "Dark or light",
			title: "Dark or light",
			onClick: () => e.set({ dark: !(t.dark ?? matchMedia("(prefers-color-scheme: dark)").matches) }),
			children: "◐"
		})
	] });
}
function hl({ store: e, state: t }) {
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
			sweep: null,
			plan: null,
			planShown: !1,
			asking: null,
			bottom: !1
		}), e.ask("open", {
			...t,
			level: ""
		});
	}, i = () => {
		let t = prompt("Name of the file", "model.toml");
		t && e.ask("save as", { file: t.endsWith(".toml") ? t : `${t}.toml` });
	}, a = async (n, r = !1) => {
		try {
			let { content: i, name: a } = await e.transport.ask("picture", {
				form: n,
				schematic: r,
				mode: t.mode
			}), o = Uint8Array.from(atob(i), (e) => e.charCodeAt(0)), s = document.createElement("a");
			s.href = URL.createObjectURL(new Blob([o])), s.download = a, s.click(), URL.revokeObjectURL(s.href);
		} catch (t) {
			e.refused(t);
		}
	}, o = t.stock;
	return /* @__PURE__ */ z("details", {
		class: "menu",
		children: [/* @__PURE__ */ z("summary", {
			"aria-label": "Menu",
			children: "hybond"
		}), /* @__PURE__ */ z("div", {
			class: "sheet",
			onClick: (e) => e.target.tagName === "BUTTON" && n(e),
			children: [
				/* @__PURE__ */ z("button", {
					onClick: () => r({}),
					children: "New model"
				}),
				/* @__PURE__ */ z("button", {
					onClick: i,
					children: "Save as …"
				}),
				/* @__PURE__ */ z("hr", {}),
				[
					"svg",
					"pdf",
					"png",
					"tex"
				].map((e) => /* @__PURE__ */ z("button", {
					onClick: () => void a(e),
					children: ["Picture as ", e === "tex" ? "TikZ" : e.toUpperCase()]
				})),
				/* @__PURE__ */ z("button", {
					onClick: () => void a("svg", !0),
					children: "Schematic as SVG"
				}),
				/* @__PURE__ */ z("hr", {}),
				/* @__PURE__ */ z("label", { children: [
					"open",
					" ",
					/* @__PURE__ */ z("select", {
						"aria-label": "Open a file",
						value: "",
						onChange: (e) => {
							r({ file: e.currentTarget.value }), n(e);
						},
						children: [/* @__PURE__ */ z("option", {
							value: "",
							children: "a file …"
						}), o?.files.map((e) => /* @__PURE__ */ z("option", { children: e }))]
					})
				] }),
				/* @__PURE__ */ z("label", { children: [
					"open",
					" ",
					/* @__PURE__ */ z("select", {
						"aria-label": "Open an example",
						value: "",
						onChange: (e) => {
							r({ example: e.currentTarget.value }), n(e);
						},
						children: [/* @__PURE__ */ z("option", {
							value: "",
							children: "an example …"
						}), o?.examples.map((e) => /* @__PURE__ */ z("option", { children: e }))]
					})
				] }),
				/* @__PURE__ */ z("small", { children: ["hybond ", o?.version] })
			]
		})]
	});
}
// src/sharing.ts
function gl(e, t) {
	if (e === t || typeof t != "object" || !t || typeof e != "object" || !e || Array.isArray(e) !== Array.isArray(t)) return t;
	let [n, r] = [e, t], i = Object.keys(r), a = i.length === Object.keys(n).length;
	for (let e of i) {
		let t = gl(n[e], r[e]);
		r[e] = t, a &&= t === n[e] && e in n;
	}
	return a ? e : t;
}
// src/store.ts
var _l = {
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
	sweep: null,
	asking: null,
	plan: null,
	planShown: !1,
	looked: null,
	cursor: null,
	instant: null,
	plotted: [],
	span: [0, 1],
	adding: !1,
	finding: !1,
	arranged: 0,
	bottom: !1,
	panel: "",
	dark: null,
	flowing: !1,
	phase: !1,
	schematic: !1,
	room: {
		side: 340,
		low: 0
	}
}, vl = [
	"C",
	"I",
	"R",
	"G",
	"Se",
	"Sf"
], yl = .9;
function bl(e) {
	let t = e.ports ?? [];
	return t.length ? Ae(e, t.map((e, t) => "we"[t % 2]).join("")).half / Ee[0] : .3;
}
var xl = 32, Sl = class {
	transport;
	state = _l;
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
		let { now: n } = await this.transport.ask("plan state");
		this.set({ plan: n });
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
		e instanceof cl ? this.set({ notice: e.problem }) : this.state.connected && this.set({ notice: {
			code: "",
			where: "",
			why: String(e),
			try: ""
		} });
	}
	take(e) {
		let t = gl(this.state.look, e), n = new Set(t.view.nodes.map((e) => e.name)), r = new Set(t.view.bonds.map((e) => e.key));
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
		else if (e.tell === "sweeping") this.set({
			sweep: {
				...e,
				members: [],
				done: !1
			},
			planShown: !1,
			bottom: !0
		});
		else if (e.tell === "member" || e.tell === "swept") {
			let { sweep: t } = this.state;
			if (t?.sweep !== e.sweep || !t) return;
			let n = [...t.members];
			e.tell === "member" && (n[e.member] = e), this.set({ sweep: {
				...t,
				members: n,
				done: e.tell === "swept"
			} });
		} else if (e.tell === "planning") {
			let { plan: t } = this.state;
			t?.plan === e.plan && this.set({ plan: {
				...t,
				...e
			} });
		} else if (e.tell === "partial") this.set({ soFar: e });
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
		let t = new Set((this.state.look?.view.nodes ?? []).map((e) => e.name)), n = this.state.plotted.some((n) => e.names?.includes(n) || t.has(n.replace(/\.[ef]$/, "")));
		this.set({
			run: e,
			plotted: n ? this.state.plotted : (e.plot ?? []).slice(0, xl),
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
	async arrange() {
		await this.ask("arrange", { keep: [...this.state.nodes] }) && this.set({ arranged: this.state.arranged + 1 });
	}
	async add(e, t, n) {
		let r = new Set(this.state.look?.view.nodes.map((e) => e.name)), i = n ?? this.freePlace(e), a = (await this.edit({
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
	freePlace(e) {
		let t = this.state.look?.view.nodes ?? [];
		if (!t.length) return [0, 0];
		let n = vl.find((t) => t in e), r = t.findIndex((e) => this.state.nodes.has(e.name)), i = t.slice(0, r < 0 ? t.length : r + 1), a = i.filter((e) => !vl.includes(e.kind)), o = a[a.length - 1] ?? i[i.length - 1], s = "submodel" in e, c = (e, n) => t.some((t) => Math.abs(t.x - e) < bl(t) + (s ? yl : .3) && Math.abs(t.y - n) < (t.ports?.length || s ? .9 : .6)), l = Math.round(o.x), u = Math.round(o.y), d = n?.startsWith("S") ? [[-1, 0]] : [], f = n && a.length ? [
			...d,
			[0, -1],
			[0, 1]
		] : [], p = s || bl(o) > .3 ? [
			[1, 0],
			[2, 0],
			[3, 0],
			[4, 0]
		] : [], m = [
			...f,
			...p,
			[1, 0],
			[0, -1],
			[0, 1],
			[-1, 0],
			[1, -1],
			[1, 1],
			[2, 0]
		];
		for (let [e, t] of m) if (!c(l + e, u + t)) return [l + e, u + t];
		for (let e = 3;; e++) if (!c(l + e, u)) return [l + e, u];
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
				sweep: null,
				planShown: !1,
				bottom: !0
			});
		} catch (e) {
			this.refused(e);
		}
	}
	async sweepPlan(e) {
		try {
			let t = await this.transport.ask("plan begin", e);
			this.set({
				plan: t,
				planShown: !0,
				bottom: !0,
				panel: ""
			});
		} catch (e) {
			this.refused(e);
		}
	}
	async openMember(e) {
		try {
			let { run: t } = await this.transport.ask("plan open", {
				plan: this.state.plan?.plan,
				member: e,
				names: this.state.plotted
			});
			this.state.runs.some((e) => e.run === t) || this.set({
				running: {
					run: t,
					t: 0,
					events: 0
				},
				soFar: null
			}), this.set({
				sweep: null,
				planShown: !1,
				bottom: !0
			});
		} catch (e) {
			this.refused(e);
		}
	}
	async sweep(e) {
		try {
			return await this.transport.ask("sweep", {
				...e,
				names: this.state.plotted
			}), !0;
		} catch (e) {
			return this.refused(e), !1;
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
				level: this.state.level,
				names: this.state.plotted
			}), o = gl(this.state.cursor?.strokes ?? this.state.look?.strokes, a.strokes);
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
// src/widget.tsx
function Cl({ model: e, el: t }) {
	let n = new ll(), r = new Sl(n), i = (e) => n.received(e);
	return e.on("msg:custom", i), n.connected({ send: (t) => e.send(t) }), t.style.height = `${e.get("height")}px`, t.classList.add("hybond-widget"), F(/* @__PURE__ */ z(fl, { store: r }), t), r.begin(), () => {
		e.off("msg:custom", i), F(null, t);
	};
}
var wl = { render: Cl };
export { wl as default, Cl as render };
