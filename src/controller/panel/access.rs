//! Access to protected pages: what the passwords of this power-on have opened.
//!
//! Passwords are never compared here: they go to the disk thread, and the answer comes back as a command.
//! Source: spec B6, K6.2.

use crate::defs::param::AccessLevel;
use crate::defs::text::Text;
use crate::link::page_command::PasswordScope;
use crate::link::snapshot::AccessView;
use crate::units::Micros;

/// Consecutive wrong passwords that start a lock-out.
const MAX_WRONG_PASSWORDS: u32 = 3;
/// Length of the lock-out.
const PAUSE: Micros = Micros::from_millis(30_000);

const WRONG: Text = Text::new("密码错误", "wrong password");
const TOO_OFTEN: Text = Text::new("密码错误次数过多，30 秒后再试", "too many wrong passwords: try again in 30 s");
const BUSY: Text = Text::new("正在核对密码，请稍候", "a password is being checked");

/// The access of the operator. At power-on every level is locked.
#[derive(Clone, Debug, Default)]
pub struct Access {
    view: AccessView,
    wrong_passwords: u32,
    locked_until: Micros,
}

impl Access {
    /// Every level locked, after a number of wrong passwords in a row before the power went: a restart saves no lock-out.
    #[must_use]
    pub fn at_power_on(wrong_passwords: u32, now: Micros) -> Self {
        let mut access = Self { wrong_passwords, ..Self::default() };
        access.lock_out(now);
        access
    }

    /// Number of wrong passwords in a row.
    #[must_use]
    pub const fn wrong_passwords(&self) -> u32 {
        self.wrong_passwords
    }

    /// Locks the input after every third wrong password in a row.
    fn lock_out(&mut self, now: Micros) {
        if self.wrong_passwords > 0 && self.wrong_passwords.is_multiple_of(MAX_WRONG_PASSWORDS) {
            self.locked_until = now + PAUSE;
        }
    }

    /// What the pages show.
    #[must_use]
    pub const fn view(&self) -> AccessView {
        self.view
    }

    /// Whether the machine builder's password was entered.
    #[must_use]
    pub fn is_builder(&self) -> bool {
        self.view.level >= AccessLevel::Builder
    }

    /// Whether the program password was entered (K6.2).
    #[must_use]
    pub const fn may_edit_programs(&self) -> bool {
        self.view.program_unlocked
    }

    /// Begins a password check.
    ///
    /// # Errors
    /// A check is pending, or three wrong passwords have locked the input for 30 s.
    pub fn begin_check(&mut self, now: Micros) -> Result<(), Text> {
        if self.view.password_pending {
            return Err(BUSY);
        }
        if now < self.locked_until {
            self.answer(Some(TOO_OFTEN));
            return Err(TOO_OFTEN);
        }
        self.view.password_pending = true;
        Ok(())
    }

    /// The password was right: opens what it guards.
    pub fn unlock(&mut self, guard: PasswordScope) {
        self.view.level = self.view.level.max(guard.level());
        self.view.program_unlocked |= guard == PasswordScope::Program;
        self.accept();
    }

    /// The password was right or has been changed.
    pub const fn accept(&mut self) {
        self.wrong_passwords = 0;
        self.answer(None);
    }

    /// The password was wrong. Returns the refusal.
    pub fn reject(&mut self, now: Micros) -> Text {
        self.wrong_passwords = self.wrong_passwords.saturating_add(1);
        self.lock_out(now);
        self.answer(Some(WRONG));
        WRONG
    }

    /// Answers the page that asked for a password check.
    pub const fn answer(&mut self, refused: Option<Text>) {
        self.view.password_pending = false;
        self.view.answer_count = self.view.answer_count.wrapping_add(1);
        self.view.refused = refused;
    }

    /// Locks every level again.
    pub const fn lock(&mut self) {
        self.view.level = AccessLevel::Operator;
        self.view.program_unlocked = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b6_three_wrong_passwords_lock_the_input_for_30_s() {
        let mut access = Access::default();
        for _ in 0..3 {
            assert_eq!(access.begin_check(Micros(1_000)), Ok(()));
            assert_eq!(access.begin_check(Micros(1_000)), Err(BUSY), "one at a time");
            assert_eq!(access.reject(Micros(1_000)), WRONG);
        }
        assert_eq!(access.begin_check(Micros(30_000_999)), Err(TOO_OFTEN));
        assert_eq!(access.begin_check(Micros(30_001_000)), Ok(()));
        access.reject(Micros(30_001_000));
        assert_eq!(access.begin_check(Micros(30_001_001)), Ok(()), "a fourth one in a row");
        access.unlock(PasswordScope::Program);
        assert_eq!(access.wrong_passwords(), 0);
        assert!(access.may_edit_programs() && !access.is_builder());
        access.lock();
        assert!(!access.may_edit_programs());
    }

    #[test]
    fn b6_a_restart_saves_no_lock_out() {
        let mut locked = Access::at_power_on(6, Micros(500));
        assert_eq!(locked.begin_check(Micros(30_000_499)), Err(TOO_OFTEN));
        assert_eq!(locked.begin_check(Micros(30_000_500)), Ok(()));
        let mut open = Access::at_power_on(2, Micros(0));
        assert_eq!(open.begin_check(Micros(0)), Ok(()));
        open.reject(Micros(0));
        assert_eq!((open.wrong_passwords(), open.begin_check(Micros(1))), (3, Err(TOO_OFTEN)));
    }
}
