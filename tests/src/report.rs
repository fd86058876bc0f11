//! What a validation found, as a table and a verdict.

/// One validation: a table in Markdown, and whether it came out as it should.
#[derive(Debug)]
pub(crate) struct Section {
    pub(crate) title: String,
    /// What was done and what is required, in words.
    pub(crate) text: String,
    pub(crate) header: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<String>>,
    pub(crate) passed: bool,
}

impl Section {
    pub(crate) fn markdown(&self) -> String {
        // A bar within a cell would end it.
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let header: Vec<String> = self.header.iter().map(ToString::to_string).collect();
        let rule = vec!["---".to_owned(); header.len()];
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        let outcome = if self.passed { "passed" } else { "FAILED" };
        format!(
            "## {}\n\n{}\n\n{}{}{rows}\nOutcome: **{outcome}**\n",
            self.title,
            self.text,
            line(&header),
            line(&rule)
        )
    }
}
