#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/column_name.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

struct TableOptions {
  /// Whether these names are the header that the caller can use. The first line, comment or not, for which
  /// this is true is the header; without it, the table has none.
  std::function<bool(const std::vector<ColumnName>&)> is_header;
  /// The kind of the finding for a row that is passed over.
  std::string finding = "csv_row";
  /// Without a header, the first row of as many cells states the number of columns.
  std::size_t least_columns = 1;
  /// How many cells a row may lack at its end; they are empty then.
  std::size_t optional_columns = 0;
  /// Whether a table of which no row fits is an error, rather than a table without rows.
  bool needs_rows = true;
  /// Whether a row with another number of cells is an error, rather than passed over. A last row that was cut
  /// off never is.
  bool refuses_misfits = false;
  /// Rows may end early; the cells that are not there are empty.
  bool rows_may_be_short = false;
};

/// Reads a table of text row by row, whatever wrote it: UTF-8, UTF-16 or Latin-1, plain or compressed with
/// gzip; LF, CRLF or CR; commas, semicolons, tabs or blanks; quotes, decimal commas; comments (`#`, `%`,
/// `//`); lines before the header; the units of the columns in a line below it.
///
///     TableReader table(openFile(path), path.string(), {isHeader}, &diagnostics);
///     while (table.next()) use(table.number(time_column));
///
/// The header, or without one the first row, states the number of columns; rows with another number are
/// reported and passed over. Memory does not grow with the length of the file.
class TableReader {
 public:
  /// `name` is for messages. Throws InputError where the bytes are no text. `diagnostics` must outlive the
  /// reader.
  TableReader(std::unique_ptr<ByteSource> bytes, std::string name, TableOptions options,
              Diagnostics* diagnostics);
  TableReader(const std::filesystem::path& file, TableOptions options, Diagnostics* diagnostics)
      : TableReader(openFile(file), file.string(), std::move(options), diagnostics) {}

  bool hasHeader() const { return !columns_.empty(); }
  const std::vector<ColumnName>& columns() const { return columns_; }  ///< of the header; else empty
  /// Of every row; 0 where there is no row.
  std::size_t columnCount() const { return column_count_; }
  /// The lines that stand before the first row and are not the header, as written; the first 1000.
  const std::vector<std::string>& preamble() const { return preamble_; }
  /// The last line before the first row that is neither header nor comment: a header that the caller did not
  /// know, for messages. Empty where there is none.
  const std::string& unknownHeader() const { return unknown_header_; }

  Separator separator() const { return separator_; }  ///< of the rows
  /// The word before each row, as in `Raw:1,2,3`; rows with another or without are passed over. Mostly empty.
  const std::string& label() const { return label_; }

  /// Moves to the next row that has as many cells as there are columns; false after the last one. Throws
  /// InputError at the end where rows were there and none of them did (TableOptions::needs_rows).
  bool next();

  std::string_view cell(std::size_t column) const { return cells_[column]; }
  /// The cell as a number (numberFrom), perhaps NaN or infinite.
  std::optional<double> number(std::size_t column) const { return numberFrom(cells_[column]); }
  /// The cell as a time in `unit`, exact to the nanosecond.
  std::optional<int64_t> time_ns(std::size_t column, TimeUnit unit) const {
    const std::string_view cell = cells_[column];
    // A cell of digits and points is as it should be, and no text has to be made of it.
    const bool is_plain = cell.find_first_not_of("0123456789.+-eE") == std::string_view::npos;
    return is_plain ? parseTime_ns(cell, unit) : parseTime_ns(withDecimalPoint(cell), unit);
  }

  int line() const { return line_number_; }
  std::string where() const;                     ///< "file:line"
  bool isCutOff() const { return is_cut_off_; }  ///< the file ends within this row

  /// Reports that this row cannot be used and why.
  void passOver(const std::string& problem);

 private:
  struct Line {
    std::string text;
    int number = 0;
    bool was_too_long = false;
    bool is_cut_off = false;
  };

  bool takeLine(Line* line);
  void readPreamble();
  bool readAsHeader(const Line& line, std::string_view text);
  bool splitNames(std::string_view text, Separator separator, std::vector<ColumnName>* names);
  void readUnitsBelow();
  void settleSeparator();
  void takeHeaderAsProse();
  void nameFurtherColumns(std::size_t count);
  void split(std::string_view text, Separator separator, std::vector<std::string_view>* cells);
  /// Whether cells_ are as many as the columns, after empty ones at the end are taken off.
  bool fits();
  void reportMisfit();
  /// Throws InputError where the row is a header with other columns: what follows would be misread.
  void refuseOtherHeader();

  TextLines lines_;
  std::string name_;
  TableOptions options_;
  Diagnostics* diagnostics_;
  std::deque<Line> pending_;  ///< read already, yet to be given out
  std::vector<ColumnName> columns_;
  std::string header_text_;
  int header_line_ = 0;
  bool header_is_comment_ = false;
  std::vector<std::string> preamble_;
  std::string unknown_header_;
  std::string label_;
  std::size_t column_count_ = 0;
  Separator separator_ = Separator::Comma;
  Line line_;
  int line_number_ = 0;
  bool is_cut_off_ = false;
  std::vector<std::string_view> cells_;
  std::vector<std::string> unquoted_;
  std::size_t fitting_rows_ = 0;
  std::string first_misfit_;
};

}  // namespace lodeline
