// Decodes a stroke on a Huion H640P: a report's bytes in, millimetres and pressure out.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sculptd.h"

namespace {

void check(SculptdStatus status) {
    if (status != SCULPTD_STATUS_OK) {
        throw std::runtime_error(sculptd_error_message());
    }
}

// A tablet that frees itself.
class Tablet {
  public:
    Tablet(std::uint16_t vendor, std::uint16_t product, const std::string &name,
           const std::vector<std::uint8_t> &descriptor) {
        SculptdTablet *made = nullptr;
        check(sculptd_tablet_open(vendor, product, name.c_str(), descriptor.data(),
                                  descriptor.size(), &made));
        tablet_.reset(made);
    }

    std::string name() const { return sculptd_tablet_name(tablet_.get()); }

    std::vector<SculptdPenSample> report(const std::vector<std::uint8_t> &bytes,
                                         std::uint64_t t_us) {
        std::array<SculptdPenSample, 16> room;
        std::size_t count = room.size();
        check(sculptd_tablet_report(tablet_.get(), bytes.data(), bytes.size(), t_us, room.data(),
                                    &count));
        return {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(count)};
    }

  private:
    struct Free {
        void operator()(SculptdTablet *t) const { sculptd_tablet_free(t); }
    };
    std::unique_ptr<SculptdTablet, Free> tablet_;
};

} // namespace

int main() try {
    // The descriptor of the vendor's own interface, and the reports of a short stroke.
    const std::vector<std::uint8_t> descriptor = {0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x08,
                                                  0x75, 0x08, 0x95, 0x0b, 0x09, 0x01, 0x81, 0x02, 0xc0};
    const std::vector<std::vector<std::uint8_t>> reports = {
        {0x08, 0x80, 0x10, 0x27, 0x88, 0x13, 0x00, 0x00, 0x00, 0x00, 0x0a, 0xf6},
        {0x08, 0x81, 0x20, 0x27, 0x90, 0x13, 0x00, 0x02, 0x00, 0x00, 0x0a, 0xf6},
        {0x08, 0x81, 0x60, 0x27, 0xb0, 0x13, 0x00, 0x08, 0x00, 0x00, 0x0b, 0xf6},
        {0x08, 0x80, 0xc0, 0x27, 0xe0, 0x13, 0x00, 0x00, 0x00, 0x00, 0x0b, 0xf5},
        {0x08, 0x00, 0xc0, 0x27, 0xe0, 0x13, 0x00, 0x00, 0x00, 0x00, 0x0b, 0xf5},
    };
    Tablet tablet(0x256c, 0x006d, "HUION Huion Tablet H640P", descriptor);
    std::printf("%s\n", tablet.name().c_str());
    std::uint64_t t_us = 0;
    unsigned touching = 0;
    for (const auto &report : reports) {
        t_us += 4000;
        for (const SculptdPenSample &s : tablet.report(report, t_us)) {
            touching += s.tip ? 1 : 0;
            std::printf("%6llu us  %7.2f mm %7.2f mm  pressure %.3f%s%s\n",
                        static_cast<unsigned long long>(s.t_us), static_cast<double>(s.x_mm),
                        static_cast<double>(s.y_mm), static_cast<double>(s.pressure),
                        s.tip ? "  touching" : "", s.in_range ? "" : "  gone");
        }
    }
    return touching > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception &e) {
    std::fprintf(stderr, "%s\n", e.what());
    return EXIT_FAILURE;
}
