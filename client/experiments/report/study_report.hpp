#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/query_result.hpp"
#include "client/experiments/pipeline/run_record.hpp"
#include "client/experiments/pipeline/side_study.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::experiments {

/// A side study and what came of it.
struct SideResults {
  SideStudy side;
  std::vector<QueryResult> results;
};

/// Everything a report is made of.
struct ReportData {
  std::vector<QueryResult> calibration;     ///< may be empty
  std::vector<QueryResult> test;            ///< of the main cells
  std::vector<Distribution> distributions;  ///< target by target, source by source
  std::vector<RunRecord> runs;              ///< of the test set
  std::vector<SideResults> sides;           ///< may be empty
};

/// One HTML file that loads nothing: calibration, the paper's tables with its figures beside ours,
/// ratios and tests, bars, what the server made of the experience, clouds of samples.
void write_study_report(const Study& study, const std::vector<StudyMember>& fleet,
                        const ReportData& data, std::ostream& out);

/// The bars of the collision checks alone, an SVG document.
void write_checks_figure(const Study& study, const ReportData& data, std::ostream& out);

}  // namespace kinship::experiments
