// The closed circuit of plant `eha`, from left to right: driver, motor (winding), shaft, pump; above the line of port 1
// to chamber A, below that of port 2 to chamber B; the cylinder with piston, its seal and the rod.
#include <array>

#include "services/common/report/drawing_parts.hpp"

namespace sealwatch::report {
namespace {

constexpr std::string_view kPipes =
    "<path class=\"pipe\" d=\"M362 172V74H430M520 74H606V160\"/>\n"
    "<path class=\"pipe\" d=\"M362 248V346H430M520 346H826V260\"/>\n"
    "<path class=\"wire\" d=\"M116 210H160\"/>\n"
    "<path class=\"rod\" d=\"M740 202H940V218H740Z\"/>\n";

constexpr auto kParts = std::to_array<Part>({
    {"driver", "<rect x=\"24\" y=\"180\" width=\"92\" height=\"60\" rx=\"4\"/>",
     "<path d=\"M40 226L52 194H60L72 226H80L100 194\"/>", 70, 256},
    {"winding", "<circle cx=\"202\" cy=\"210\" r=\"42\"/>",
     "<path d=\"M178 214c0 -14 12 -14 12 0c0 -14 12 -14 12 0c0 -14 12 -14 12 0c0 -14 12 -14 12 0\"/>", 202, 268},
    {"shaft", "<rect x=\"244\" y=\"203\" width=\"76\" height=\"14\"/>", "<path d=\"M250 210H314\"/>", 282, 234},
    {"pump", "<circle cx=\"362\" cy=\"210\" r=\"42\"/>",
     "<path class=\"solid\" d=\"M362 168L350 186H374ZM362 252L350 234H374Z\"/>", 412, 214, "start"},
    {"valve_1", "<rect x=\"430\" y=\"54\" width=\"90\" height=\"40\" rx=\"3\"/>",
     "<path d=\"M436 74H462M484 74H514M484 60L470 74L484 88\"/><circle class=\"solid\" cx=\"466\" cy=\"74\" r=\"5\"/>",
     475, 110},
    {"valve_2", "<rect x=\"430\" y=\"326\" width=\"90\" height=\"40\" rx=\"3\"/>",
     "<path d=\"M436 346H462M484 346H514M484 332L470 346L484 360\"/>"
     "<circle class=\"solid\" cx=\"466\" cy=\"346\" r=\"5\"/>",
     475, 382},
    {"chamber_a", "<rect x=\"580\" y=\"160\" width=\"130\" height=\"100\"/>", "", 646, 214, "middle", true},
    {"chamber_b", "<path d=\"M740 160H860V202H740ZM740 218H860V260H740Z\"/>", "", 800, 180, "middle", true},
    {"piston", "<rect x=\"710\" y=\"168\" width=\"30\" height=\"84\"/>", "<path d=\"M725 176V128\"/>", 725, 110},
    {"piston_seal", "<path d=\"M710 160H740V168H710ZM710 252H740V260H710Z\"/>", "<path d=\"M725 256V280\"/>", 725, 292},
    {"fluid", "<path d=\"M290 318c0 -14 16 -22 16 -40c0 18 16 26 16 40a16 16 0 0 1 -32 0\"/>", "", 284, 318, "end"},
});

struct SensorPlace {
  std::string_view channel, letters;
  double x, y;
  std::string_view lead;  ///< to what it measures
};

constexpr auto kSensors = std::to_array<SensorPlace>({
    {"motor_voltage", "u", 70, 140, "M70 152V180"},
    {"motor_current", "i", 138, 140, "M138 152V210"},
    {"shaft_speed", "ω", 282, 140, "M282 152V203"},
    {"pressure_a", "pA", 646, 140, "M646 152V160"},
    {"pressure_b", "pB", 786, 140, "M786 152V160"},
    {"pressure_differential", "Δp", 616, 296, "M616 284V260M628 296H660V326H790V260"},
    {"flow", "Q", 560, 40, "M560 52V74"},
    {"position", "x", 880, 160, "M880 172V202"},
    {"velocity", "v", 920, 160, "M920 172V202"},
    {"rod_force", "F", 920, 260, "M920 248V218"},
    {"fluid_temperature", "T", 306, 366, "M306 354V334"},
});

}  // namespace

std::optional<std::string> own_drawing(const Colouring& colouring) {
  if (colouring.plant().name != "eha") return std::nullopt;
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" class=\"drawing\" width=\"960\" height=\"376\" "
      "viewBox=\"12 20 940 368\">\n<title>Where the mismatch sits in the actuator</title>\n";
  svg += kPipes;
  for (const SensorPlace& sensor : kSensors)
    svg.append("<path class=\"lead\" d=\"").append(sensor.lead).append("\"/>\n");
  for (const Part& part : kParts) svg += colouring.part(part);
  for (const SensorPlace& sensor : kSensors)
    svg += colouring.sensor(sensor.channel, sensor.letters, sensor.x, sensor.y);
  return svg.append("</svg>\n");
}

}  // namespace sealwatch::report
