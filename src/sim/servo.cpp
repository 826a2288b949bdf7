#include "src/sim/servo.hpp"

#include <algorithm>

namespace quern {

void Servo::steer(double time, double dt) {
    const double push = per * force(time) - pressed, guide = 0.5 * damping * dt;
    speed = std::clamp((speed * (1.0 - guide) + dt * push / mass) / (1.0 + guide), -max_speed, max_speed);
}

}  // namespace quern
