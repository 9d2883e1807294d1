#pragma once

#include <fmt/format.h>
#include <tinyxml2.h>

#include <functional>
#include <string>

namespace mvtp {

/// Writes XML as nested calls: the elements of `inside` stand in `name`. Numbers have no exponent,
/// as the type "decimal" of XML schemas demands.
class XmlWriter {
 public:
  XmlWriter() { printer_.PushHeader(/*writeBOM=*/false, /*writeDeclaration=*/true); }

  void element(const char* name, const std::function<void()>& inside) {
    printer_.OpenElement(name);
    inside();
    printer_.CloseElement();
  }
  /// <name>text</name>
  void text(const char* name, const std::string& text) {
    element(name, [&] { printer_.PushText(text.c_str()); });
  }
  void number(const char* name, double value, int digits = 4) { text(name, fixed(value, digits)); }

  // Of the element that was opened last, before anything is inside.
  void attribute(const char* name, const std::string& value) {
    printer_.PushAttribute(name, value.c_str());
  }
  void attribute(const char* name, double value, int digits = 4) {
    printer_.PushAttribute(name, fixed(value, digits).c_str());
  }
  void comment(const std::string& text) { printer_.PushComment(text.c_str()); }

  [[nodiscard]] std::string str() const { return {printer_.CStr()}; }

  [[nodiscard]] static std::string fixed(double value, int digits) {
    return fmt::format("{:.{}f}", value, digits);
  }

 private:
  tinyxml2::XMLPrinter printer_;
};

}  // namespace mvtp
