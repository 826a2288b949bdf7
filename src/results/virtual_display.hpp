// A screen for machines that have none.
#pragma once

#include <sys/types.h>

#include <string>

namespace quern {

/// An X server in memory (Xvfb) for the life of this object. Debian's VTK draws through X even off screen.
///
/// A server of our own is preferred to the user's: pictures then do not depend on the screen, on a forwarded
/// connection or on a stale DISPLAY, and several programs can draw at once (the server picks a free number).
/// Where Xvfb is missing, the DISPLAY of the environment serves; without that, OutputError says what to
/// install. DISPLAY is put back at the end. Objects may not overlap in one process.
class VirtualDisplay {
  public:
    VirtualDisplay();
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  private:
    void stop();

    pid_t server_ = -1;
    bool had_display_ = false;
    std::string display_before_;
};

}  // namespace quern
