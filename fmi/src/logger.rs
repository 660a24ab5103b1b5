//! Messages to the importer, through its logger callback and nowhere else.
//!
//! The callback takes a printf format in which `#` is special too (`#r12#` names a variable), so
//! both signs are doubled and no arguments follow. Only categories that modelDescription.xml
//! declares are used.
#![allow(unsafe_code, reason = "calls the importer's function")]

use crate::types::{fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status};
use std::ffi::{CStr, CString};

/// A log category, as declared in modelDescription.xml.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Category {
    /// What happens when: debug logging.
    Events,
    /// The solver's iterations: debug logging.
    NonlinearSystems,
    /// Belongs to `fmi2Warning`.
    StatusWarning,
    /// Belongs to `fmi2Discard`.
    StatusDiscard,
    /// Belongs to `fmi2Error`.
    StatusError,
    /// Belongs to `fmi2Fatal`.
    StatusFatal,
}

impl Category {
    const ALL: [Self; 6] = [
        Self::Events,
        Self::NonlinearSystems,
        Self::StatusWarning,
        Self::StatusDiscard,
        Self::StatusError,
        Self::StatusFatal,
    ];

    fn name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::NonlinearSystems => c"logNonlinearSystems",
            Self::StatusWarning => c"logStatusWarning",
            Self::StatusDiscard => c"logStatusDiscard",
            Self::StatusError => c"logStatusError",
            Self::StatusFatal => c"logStatusFatal",
        }
    }

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Every category; what `logAll` stands for.
const ALL: u8 = 0b11_1111;
/// What is said even while debug logging is off: why something went wrong.
const STATUS: u8 = Category::StatusWarning.bit()
    | Category::StatusDiscard.bit()
    | Category::StatusError.bit()
    | Category::StatusFatal.bit();

/// The importer's logger and what it wants to hear.
#[derive(Clone, Debug)]
pub(crate) struct Logger {
    callback: Option<fmi2CallbackLogger>,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    /// Bits of the enabled categories.
    enabled: u8,
}

impl Logger {
    /// Debug categories are on if `logging_on`; the status categories are on either way.
    pub(crate) fn new(
        callback: Option<fmi2CallbackLogger>,
        environment: fmi2ComponentEnvironment,
        instance_name: CString,
        logging_on: bool,
    ) -> Self {
        Self {
            callback,
            environment,
            instance_name,
            enabled: if logging_on { ALL } else { STATUS },
        }
    }

    /// What fmi2SetDebugLogging asks for. On: exactly the categories named, or all where none is
    /// named. Off: the categories named, or the debug categories where none is named. Returns the
    /// names that are not declared.
    pub(crate) fn select(&mut self, on: bool, names: &[String]) -> Vec<String> {
        let mut bits = 0;
        let mut unknown = Vec::new();
        for name in names {
            let known = Category::ALL
                .into_iter()
                .find(|category| category.name().to_bytes() == name.as_bytes());
            match known {
                Some(category) => bits |= category.bit(),
                None if name == "logAll" => bits = ALL,
                None => unknown.push(name.clone()),
            }
        }
        if unknown.is_empty() {
            self.enabled = match (on, names.is_empty()) {
                (true, true) => ALL,
                (true, false) => bits,
                (false, true) => STATUS,
                (false, false) => self.enabled & !bits,
            };
        }
        unknown
    }

    /// Whether a message of this category would be heard; spares making it up.
    pub(crate) fn wants(&self, category: Category) -> bool {
        self.callback.is_some() && self.enabled & category.bit() != 0
    }

    /// Hands over `message` if its category is enabled.
    pub(crate) fn log(&self, status: fmi2Status, category: Category, message: &str) {
        let Some(callback) = self.callback.filter(|_| self.wants(category)) else {
            return;
        };
        let message = escaped(message);
        // SAFETY: the importer's function, with the arguments that FMI 2.0 prescribes; all strings
        // end with a zero and live until it returns, the message refers to no variadic argument.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status,
                category.name().as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

/// Bytes of a message that are handed over: many importers print it into 1024 bytes together with
/// the instance's name and the category, and not all of them look whether it fits.
const LONGEST: usize = 900;

/// `message` as a printf format that prints it; a zero byte would end it and becomes a blank. What
/// is too long ends with `…`.
fn escaped(message: &str) -> CString {
    const END: &str = "…";
    let mut format: Vec<u8> = Vec::with_capacity(message.len().min(LONGEST) + 9);
    // Where the text can be cut so that the end still fits.
    let mut cut = 0;
    for letter in message.chars() {
        match letter {
            '%' | '#' => format.extend([letter as u8; 2]),
            '\0' => format.push(b' '),
            _ => format.extend(letter.encode_utf8(&mut [0; 4]).bytes()),
        }
        if format.len() + END.len() <= LONGEST {
            cut = format.len();
        }
        if format.len() > LONGEST {
            format.truncate(cut);
            format.extend(END.bytes());
            break;
        }
    }
    CString::new(format).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logger(on: bool) -> Logger {
        unsafe extern "C" fn ignore(
            _: fmi2ComponentEnvironment,
            _: *const std::ffi::c_char,
            _: fmi2Status,
            _: *const std::ffi::c_char,
            _: *const std::ffi::c_char,
        ) {
        }
        // SAFETY: a callee that reads no variadic argument has the same calling convention on every
        // platform that this test runs on; it is never called here.
        let callback =
            unsafe { std::mem::transmute::<*const (), fmi2CallbackLogger>(ignore as *const ()) };
        Logger::new(Some(callback), std::ptr::null_mut(), c"robot".into(), on)
    }

    fn heard(logger: &Logger) -> Vec<&str> {
        Category::ALL
            .into_iter()
            .filter(|category| logger.wants(*category))
            .map(|category| category.name().to_str().expect("ASCII"))
            .collect()
    }

    #[test]
    fn percent_and_hash_are_doubled_and_a_nul_does_not_cut_the_message() {
        assert_eq!(
            escaped("100 %s #r1#\0end").as_bytes(),
            b"100 %%s ##r1## end"
        );
    }

    #[test]
    fn a_long_message_is_cut_between_letters_and_says_so() {
        assert_eq!(escaped(&"a".repeat(900)).as_bytes().len(), 900);
        let cut = escaped(&"%".repeat(2000));
        assert_eq!(cut.as_bytes().len(), 899);
        assert!(cut.to_str().is_ok_and(|text| text.ends_with("%%…")));
        let cut = escaped(&"ω".repeat(2000));
        let text = cut.to_str().expect("whole letters");
        assert!(text.len() <= 900 && text.ends_with("ω…"), "{}", text.len());
    }

    #[test]
    fn errors_are_logged_while_debug_logging_is_off() {
        let status = [
            "logStatusWarning",
            "logStatusDiscard",
            "logStatusError",
            "logStatusFatal",
        ];
        assert_eq!(heard(&logger(false)), status);
        let mut logger = logger(true);
        assert_eq!(heard(&logger).len(), 6);
        logger.select(false, &[]);
        assert_eq!(heard(&logger), status);
    }

    #[test]
    fn only_the_selected_categories_are_logged() {
        let mut logger = logger(false);
        assert!(logger.select(true, &["logEvents".into()]).is_empty());
        assert_eq!(heard(&logger), ["logEvents"]);
        assert!(logger.select(true, &["logAll".into()]).is_empty());
        assert_eq!(heard(&logger).len(), 6);
        assert!(logger.select(false, &["logStatusError".into()]).is_empty());
        assert!(!logger.wants(Category::StatusError) && logger.wants(Category::Events));
    }

    #[test]
    fn an_unknown_category_is_returned_and_nothing_changes() {
        let mut logger = logger(false);
        let before = logger.enabled;
        let names = ["logEvents".to_owned(), "logWeather".to_owned()];
        assert_eq!(logger.select(true, &names), ["logWeather"]);
        assert_eq!(logger.enabled, before);
    }

    #[test]
    fn without_a_logger_no_message_is_made() {
        let logger = Logger::new(None, std::ptr::null_mut(), c"robot".into(), true);
        assert!(!logger.wants(Category::StatusError));
        logger.log(fmi2Status::Error, Category::StatusError, "unheard");
    }
}
