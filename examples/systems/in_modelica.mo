// The eight systems of this folder in Modelica, written by hand to compare lengths: one line for each
// declaration, connection, equation and clause. Parts are those of the Modelica Standard Library 4 where it has
// them. No tool has run this text.

model QuarterCar
  import Modelica.Mechanics.Translational;
  Translational.Sources.Speed road(exact = true);
  Translational.Components.Spring tyre(c = 200e3);
  Translational.Components.Mass wheel(m = 40, s(start = 0, fixed = true), v(start = 0, fixed = true));
  Translational.Components.SpringDamper spring(c = 20e3, d = 1200);
  Translational.Components.ElastoGap lower(c = 300e3, d = 0, s_rel0 = -0.04);
  Translational.Components.ElastoGap upper(c = 300e3, d = 0, s_rel0 = -0.06);
  Translational.Components.Mass body(m = 320, s(start = 0, fixed = true), v(start = 0, fixed = true));
equation
  road.v_ref = if time > 0.1 and time < 0.12 then 4 else 0;
  connect(road.flange, tyre.flange_a);
  connect(tyre.flange_b, wheel.flange_a);
  connect(wheel.flange_b, spring.flange_a);
  connect(spring.flange_b, body.flange_a);
  connect(wheel.flange_b, lower.flange_a);
  connect(lower.flange_b, body.flange_a);
  connect(body.flange_a, upper.flange_a);
  connect(upper.flange_b, wheel.flange_b);
end QuarterCar;

model HBridge
  import Modelica.Electrical.Analog;
  Analog.Sources.ConstantVoltage battery(V = 24);
  Analog.Basic.Ground ground;
  Analog.Ideal.IdealClosingSwitch au(Ron = 0, Goff = 0), al(Ron = 0, Goff = 0), bu(Ron = 0, Goff = 0), bl(Ron = 0, Goff = 0);
  Analog.Ideal.IdealDiode dau(Ron = 0, Goff = 0, Vknee = 0), dal(Ron = 0, Goff = 0, Vknee = 0);
  Analog.Ideal.IdealDiode dbu(Ron = 0, Goff = 0, Vknee = 0), dbl(Ron = 0, Goff = 0, Vknee = 0);
  Analog.Basic.Resistor winding(R = 1);
  Analog.Basic.Inductor coil(L = 10e-3, i(start = 0, fixed = true));
  Analog.Basic.RotationalEMF emf(k = 0.05);
  Modelica.Mechanics.Rotational.Components.Inertia rotor(J = 6e-4, w(start = 0, fixed = true));
  Modelica.Mechanics.Rotational.Components.Damper drag(d = 1e-5);
  Modelica.Mechanics.Rotational.Components.Fixed stator;
  Boolean limit(start = false, fixed = true);
equation
  limit = abs(coil.i) > 8 or pre(limit) and abs(coil.i) >= 7;
  au.control = time < 0.5 and not limit;
  al.control = not au.control;
  bu.control = time >= 0.5 and not limit;
  bl.control = not bu.control;
  connect(battery.p, au.p);
  connect(battery.p, bu.p);
  connect(au.n, al.p);
  connect(bu.n, bl.p);
  connect(al.n, battery.n);
  connect(bl.n, battery.n);
  connect(dau.n, au.p);
  connect(dau.p, au.n);
  connect(dal.n, al.p);
  connect(dal.p, al.n);
  connect(dbu.n, bu.p);
  connect(dbu.p, bu.n);
  connect(dbl.n, bl.p);
  connect(dbl.p, bl.n);
  connect(battery.n, ground.p);
  connect(au.n, winding.p);
  connect(winding.n, coil.p);
  connect(coil.n, emf.p);
  connect(emf.n, bu.n);
  connect(emf.flange, rotor.flange_a);
  connect(rotor.flange_b, drag.flange_a);
  connect(drag.flange_b, stator.flange);
end HBridge;

model Press
  constant Real aa = 1e-3, ab = 6e-4, bulk = 1.4e9, dead = 20e-6, stroke = 0.3;
  Real a(start = 40e-6, fixed = true) "fluid in chamber a";
  Real b(start = 188e-6, fixed = true) "fluid in chamber b";
  Real x(start = 0.02, fixed = true) "position";
  Real v(start = 0, fixed = true) "speed";
  Real pa, pb, relief, piece;
equation
  pa = bulk*(a - dead - aa*x)/(dead + aa*x);
  pb = bulk*(b - dead - ab*(stroke - x))/(dead + ab*(stroke - x));
  relief = if pa > 150e5 then (pa - 150e5)/2e10 else 0;
  piece = if x > 0.07 then 1.5e6*(x - 0.07) else 0;
  der(a) = 10e-6/(2*Modelica.Constants.pi)*150 - relief;
  der(b) = -pb/1e9;
  der(x) = v;
  50*der(v) = aa*(pa + pa^2/(2*bulk)) - ab*(pb + pb^2/(2*bulk)) - piece;
  when x > stroke then
    reinit(v, 0);
  elsewhen x < 0 then
    reinit(v, 0);
  end when;
  // a rod that stays at an end of its stroke wants a Boolean and two more equations
end Press;

model Siphon
  constant Real head = 9810;
  Real upper(start = 0.2, fixed = true) "level";
  Real lower(start = 0.1, fixed = true) "level";
  Real siphon "flow";
  Real hose "flow";
  Boolean water(start = false, fixed = true);
  Boolean open(start = true, fixed = true);
equation
  when {upper > 0.5, upper < 0} then
    water = upper > 0.5;
  end when;
  when {lower > 0.01, lower < 0} then
    open = lower > 0.01;
  end when;
  siphon = if water then head*(upper + 1 - lower)/2e6 else 0;
  hose = if open then head*(lower + 0.5)/3e6 else 0;
  0.5*der(upper) = (if time < 100 then 2e-3 else 0) - siphon;
  0.4*der(lower) = siphon - hose;
end Siphon;

model RelayCoil
  import Modelica.Electrical.Analog;
  Analog.Sources.ConstantVoltage supply(V = 24);
  Analog.Basic.Ground ground;
  Analog.Ideal.IdealClosingSwitch button(Ron = 0, Goff = 0), contact(Ron = 0, Goff = 0);
  Analog.Basic.Resistor winding(R = 240), R(R = 12), r(R = 100);
  Analog.Basic.Inductor coil(L = 2.4, i(start = 0, fixed = true)), L(L = 20e-3, i(start = 0, fixed = true));
  Analog.Ideal.IdealDiode free(Ron = 0, Goff = 0, Vknee = 0.7);
  Analog.Basic.Capacitor c(C = 0.1e-6, v(start = 0, fixed = true));
  Boolean attracted(start = false, fixed = true);
equation
  attracted = abs(coil.i) > 0.05 or pre(attracted) and abs(coil.i) >= 0.02;
  button.control = time > 5e-3 and time < 50e-3;
  contact.control = attracted;
  connect(supply.p, button.p);
  connect(button.n, winding.p);
  connect(winding.n, coil.p);
  connect(coil.n, supply.n);
  connect(supply.n, ground.p);
  connect(supply.n, free.p);
  connect(free.n, winding.p);
  connect(supply.p, R.p);
  connect(R.n, L.p);
  connect(L.n, contact.p);
  connect(contact.n, supply.n);
  connect(L.n, r.p);
  connect(r.n, c.p);
  connect(c.n, supply.n);
end RelayCoil;

model TwoSpeedGear
  import Modelica.Mechanics.Rotational;
  Rotational.Sources.Torque engine(useSupport = false);
  Rotational.Components.Inertia crank(J = 0.1, w(start = 0, fixed = true));
  Rotational.Components.IdealPlanetary gear(ratio = 2);
  Rotational.Components.Inertia rim(J = 0.05, w(start = 0, fixed = true));
  Rotational.Components.Brake brake(mu_pos = [0, 0.4], cgeo = 0.1, fn_max = 4e3);
  Rotational.Components.Clutch lock_up(mu_pos = [0, 0.4], cgeo = 0.15, fn_max = 1e3);
  Rotational.Components.Inertia load(J = 2);
equation
  engine.tau = 20;
  brake.f_normalized = if time < 3 then 1 else 0;
  lock_up.f_normalized = if time < 3 then 0 else 1;
  connect(engine.flange, crank.flange_a);
  connect(crank.flange_b, gear.sun);
  connect(gear.ring, rim.flange_a);
  connect(rim.flange_b, brake.flange_a);
  connect(crank.flange_b, lock_up.flange_a);
  connect(lock_up.flange_b, rim.flange_b);
  connect(gear.carrier, load.flange_a);
end TwoSpeedGear;

model Thermostat
  import Modelica.Thermal.HeatTransfer;
  HeatTransfer.Components.HeatCapacitor air(C = 60e3, T(start = 285.15, fixed = true));
  HeatTransfer.Components.ThermalConductor walls(G = 40);
  HeatTransfer.Sources.FixedTemperature winter(T = 273.15);
  HeatTransfer.Sources.PrescribedHeatFlow stove;
  Boolean on(start = false, fixed = true);
equation
  on = air.T < 292.15 or pre(on) and air.T <= 294.15;
  stove.Q_flow = if on then 1500 else 0;
  connect(stove.port, air.port);
  connect(air.port, walls.port_a);
  connect(walls.port_b, winter.port);
end Thermostat;

model Bungee
  import Modelica.Mechanics.Translational;
  Translational.Components.Fixed bridge;
  Translational.Components.ElastoGap rope(c = 80, d = 0, s_rel0 = -25) "pushes: turned round, it pulls";
  Translational.Components.Mass jumper(m = 75, s(start = 0, fixed = true), v(start = 0, fixed = true));
  Translational.Sources.ConstantForce weight(f_constant = -75*9.81);
equation
  connect(jumper.flange_a, rope.flange_a);
  connect(rope.flange_b, bridge.flange);
  connect(weight.flange, jumper.flange_b);
end Bungee;
