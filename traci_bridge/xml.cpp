#include "traci_bridge/xml.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "traci_bridge/packed_file.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kLongestQuote = 60;

std::string quoted(const std::string& text) {
  const bool is_long = text.size() > kLongestQuote;
  return fmt::format("\"{}{}\"", text.substr(0, kLongestQuote), is_long ? "..." : "");
}

}  // namespace

void check_readable(const std::string& path, const std::string& what) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(path, "no such file; give the path of " + what);
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path, "not a file; give the path of " + what);
  }
  if (access(path.c_str(), R_OK) != 0) {
    throw InputError(path, "may not be read; change its permissions");
  }
}

XmlFile::XmlFile(std::string path, const std::string& what) : path_(std::move(path)) {
  check_readable(path_, what);
  const bool compressed = path_.ends_with(".gz");
  const tinyxml2::XMLError error =
      compressed ? document_.Parse(unpacked(path_).c_str()) : document_.LoadFile(path_.c_str());
  if (error != tinyxml2::XML_SUCCESS) {
    throw InputError(
        path_ + ':' + std::to_string(document_.ErrorLineNum()),
        std::string("not XML (") + document_.ErrorName() + "); give the path of " + what);
  }
  if (document_.RootElement() == nullptr) {
    throw InputError(path_, "no XML element in it; give the path of " + what);
  }
}

std::string XmlFile::text(const tinyxml2::XMLElement& element, const char* name) const {
  const char* value = element.Attribute(name);
  if (value == nullptr) fail(element, name, "missing");
  return value;
}

double XmlFile::number(const tinyxml2::XMLElement& element, const char* name) const {
  const std::string value = text(element, name);
  const std::optional<double> parsed = parse_number(value);
  if (!parsed) fail(element, name, quoted(value) + " is not a finite number");
  return *parsed;
}

double XmlFile::number(const tinyxml2::XMLElement& element, const char* name,
                       double fallback) const {
  return element.Attribute(name) == nullptr ? fallback : number(element, name);
}

double XmlFile::positive(const tinyxml2::XMLElement& element, const char* name,
                         std::optional<double> fallback) const {
  const double value = fallback ? number(element, name, *fallback) : number(element, name);
  if (value <= 0.0) fail(element, name, quoted(text(element, name)) + " is not above 0");
  return value;
}

int XmlFile::index(const tinyxml2::XMLElement& element, const char* name) const {
  const double value = number(element, name);
  if (value < 0.0 || value > 1000.0 || value != std::floor(value)) {
    fail(element, name, quoted(text(element, name)) + " is not an index");
  }
  return static_cast<int>(value);
}

std::vector<Point> XmlFile::points(const tinyxml2::XMLElement& element, const char* name) const {
  std::vector<Point> points;
  for (const std::string& point : split(text(element, name), " \t\n")) {
    const std::vector<std::string> parts = split(point, ",");
    const bool complete = parts.size() == 2 || parts.size() == 3;
    const std::optional<double> x = complete ? parse_number(parts[0]) : std::nullopt;
    const std::optional<double> y = complete ? parse_number(parts[1]) : std::nullopt;
    if (!x || !y) fail(element, name, quoted(point) + " is not a point x,y");
    points.push_back({*x, *y});
  }
  return points;
}

std::string XmlFile::where(const tinyxml2::XMLElement& element) const {
  return path_ + ':' + std::to_string(element.GetLineNum());
}

void XmlFile::fail(const tinyxml2::XMLElement& element, const std::string& problem) const {
  throw InputError(where(element), problem);
}

void XmlFile::fail(const tinyxml2::XMLElement& element, const char* attribute,
                   const std::string& problem) const {
  fail(element, std::string("<") + element.Name() + "> " + attribute + ": " + problem);
}

std::string attribute(const tinyxml2::XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

std::vector<const tinyxml2::XMLElement*> children(const tinyxml2::XMLElement& parent,
                                                  const char* name) {
  std::vector<const tinyxml2::XMLElement*> found;
  for (const tinyxml2::XMLElement* child = parent.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name)) {
    found.push_back(child);
  }
  return found;
}

std::vector<std::string> split(const std::string& text, const char* separators) {
  std::vector<std::string> words;
  std::size_t begin = text.find_first_not_of(separators);
  while (begin != std::string::npos) {
    const std::size_t end = text.find_first_of(separators, begin);
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(separators, end);
  }
  return words;
}

std::optional<double> parse_number(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace mvtp
