#include <doctest/doctest.h>
#include "src/results/render.hpp"
#include <cstdlib>
#include <cmath>
#include <chrono>
#include <cstdio>
using namespace quern;
TEST_CASE("charts try") {
    Chart a, b, c, d;
    a.title="Energy of two colliding disks"; a.x_label="time [s]"; a.y_label="energy [J/m]";
    ChartLine k,e; k.label="kinetic"; e.label="elastic"; e.color=1; e.dashed=true;
    for(int i=0;i<400;++i){double t=i*0.0005; k.x.push_back(t);k.y.push_back(1e-3*(1-0.8*std::exp(-std::pow((t-0.1)/0.02,2)))); e.x.push_back(t); e.y.push_back(1e-3-k.y.back());}
    ChartLine tot; tot.label="total"; tot.color=7; tot.x=k.x; tot.y.assign(k.x.size(),1e-3);
    a.lines={k,e,tot};
    b.title="Convergence"; b.x_label="particle spacing dx [m]"; b.y_label="relative error [-]"; b.log_x=b.log_y=true;
    ChartLine m; m.label="measured"; m.markers=true; m.x={0.1,0.05,0.025,0.0125,0.00625}; for(double x:m.x)m.y.push_back(0.3*x*x*(1+0.2*std::sin(50*x)));
    ChartLine r; r.label="second order"; r.dashed=true;r.color=7; r.x=m.x; for(double x:m.x)r.y.push_back(0.3*x*x);
    b.lines={m,r};
    c.title="Many lines everywhere: the legend finds room"; c.x_label="x [m]"; c.y_label="y [mm]";
    for(int j=0;j<6;++j){ChartLine l; l.label="mu = 0."+std::to_string(j); l.color=j; l.markers=j%2; l.dashed=j==2; for(int i=0;i<200;++i){l.x.push_back(i*0.01);l.y.push_back(std::sin(i*0.05+j)*12345);} c.lines.push_back(l);}
    d.title="Points"; d.x_label="angle [deg]"; d.y_label="acceleration [m/s\u00b2]";
    ChartLine p; p.label="simulation"; p.line=false; p.color=4; for(int i=0;i<30;++i){p.x.push_back(i*3);p.y.push_back(9.81*std::sin(i*3*M_PI/180));}
    ChartLine th; th.label="theory"; th.x=p.x; th.y=p.y; d.lines={th,p};
    auto t0=std::chrono::steady_clock::now();
    draw_charts({a,b,c,d},2,"/tmp/pic/charts.png");
    printf("%.2f\n", std::chrono::duration<double>(std::chrono::steady_clock::now()-t0).count());
}
