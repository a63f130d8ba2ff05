* Bridge rectifier with a smoothing capacitor
.options reltol=1e-4 method=gear
.param f0=50 Vpk={230*sqrt(2)/10}
V1 ac1 ac2 SIN(0 {Vpk} {f0})   $ secondary
Rs ac1 a 0.5
D1 a p DM
D2 ac2 p DM
D3 0 a DM
D4 0 ac2 DM
C1 p 0 2.2mF
RL p 0 50
Rref ac2 0 1meg
.model DM D(IS=1e-14 N=0.01 RS=10m CJO=10p TT=1u BV=600)
.save v(p) v(a)
.tran 20u 200m 0 20u
.meas tran vavg AVG v(p) FROM=160m TO=200m
.meas tran ripple PP v(p) FROM=160m TO=200m
.end
