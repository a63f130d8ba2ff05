Boost converter with functions of parameters
.func gain(d) {1/(1-d)}
.func on(d,t) {d*t}
.param T=10u D=0.5 Vwant={12*gain(D)}
Vin in 0 12
L1 in sw 47uH IC=0
S1 sw 0 g 0 SWM
D1 sw out DI
C1 out 0 47uF IC={Vwant}
R1 out 0 20
Vg g 0 PULSE(0 10 0 1n 1n {on(D,T)} {T})
.model SWM SW VT=5 VH=1 RON=10m ROFF=1e8
.model DI D IS=1e-14 N=0.01
.options method=gear
.tran 50n 3m 0 50n uic
.meas tran vout AVG v(out) FROM=2.8m TO=3m
.meas tran iin AVG i(L1) FROM=2.8m TO=3m
.end
